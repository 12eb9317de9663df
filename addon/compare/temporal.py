# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a layer changes from frame to frame beyond the truth, over a short move of light or camera (docs/measures.md).

With s the layer, t its truth and D the change from one frame to the next at the same place of the same surface:
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .footprint import compute_view_positions
from .measures import MeasureInfo
from .pixels import compute_pixel_size

TEMPORAL_MEASURES = (
    MeasureInfo("temporal_rms", "Flicker", "visibility", "RMS of Ds - Dt over the pixels"),
    MeasureInfo("temporal_blocks_rms", "Flicker, blocks", "visibility", "RMS of Ds - Dt averaged over 8 x 8 pixels"),
    MeasureInfo("temporal_change_ratio", "Change ratio", "ratio", "sum of |Ds| over sum of |Dt|: 1 moves as the truth"),
    MeasureInfo("temporal_layer_rms", "Layer's change", "visibility", "RMS of Ds"),
    MeasureInfo("temporal_truth_rms", "Truth's change", "visibility", "RMS of Dt"),
)
BLOCK_PX = 8
# A place is shown in both frames if the earlier frame's points about it lie in the later point's plane, within this.
SAME_PLACE_PX = 0.5


@dataclass(frozen=True)
class SeenFrame:
    """What a frame shows. `positions_rel`, `normals` (h, w, 3) world axes, positions relative to `origin_ws` (3,), the
    camera's place; `comparable` (h, w); `camera` as in the snapshot."""

    positions_rel: NDArray[np.floating]
    normals: NDArray[np.floating]
    comparable: NDArray[np.bool_]
    origin_ws: NDArray[np.float64]
    camera: Any


@dataclass(frozen=True)
class Places:
    """Pixels of a frame that show places which the frame before shows too: `rows`, `columns` (n,) in this frame; flat
    indices (n, 4) into the frame before, and their weights (n, 4)."""

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    before: NDArray[np.intp]
    weights: NDArray[np.float64]

    def look_up(self, picture: NDArray) -> NDArray[np.float64]:
        """The earlier frame's picture (h, w) at these places: (n,), linear between its pixels."""
        return (picture.reshape(-1)[self.before] * self.weights).sum(axis=1)


def project(points_vs: NDArray[np.float64], camera: Any, width: int, height: int) -> NDArray[np.float64]:
    """View space points (n, 3) to pixels (n, 2), x to the right, y up; NaN behind the camera."""
    left, right, bottom, top = camera.window
    plane = points_vs[:, :2]
    if camera.perspective:
        depth = -points_vs[:, 2]
        plane = plane / np.where(depth > 0, depth, np.nan)[:, None]
    return (plane - [left, bottom]) / [right - left, top - bottom] * [width, height]


def find_same_places(before: SeenFrame, now: SeenFrame) -> Places:
    """Places that both frames show and that count in both. A still camera gives each pixel itself; a moved one, or a
    changed scene, the four pixels about the place, all of them on the same surface."""
    height, width = now.comparable.shape
    rows, columns = np.nonzero(now.comparable)
    points_rel = np.asarray(now.positions_rel[rows, columns], dtype=np.float64)
    matrix = np.asarray(before.camera.world_from_camera, dtype=np.float64)
    points_vs = compute_view_positions(points_rel, now.origin_ws, matrix)
    with np.errstate(invalid="ignore"):
        place = project(points_vs, before.camera, width, height) - 0.5
    # What rounding moves is not moved: a still pixel keeps its own value to the last bit.
    place = np.where(np.abs(place - np.round(place)) < 1e-4, np.round(place), place)
    inside = np.isfinite(place).all(axis=1) & (place >= 0).all(axis=1) & (place <= [width - 1, height - 1]).all(axis=1)
    rows, columns, points_rel, place = rows[inside], columns[inside], points_rel[inside], place[inside]
    corner = np.minimum(np.floor(place).astype(np.intp), [max(width - 2, 0), max(height - 2, 0)])
    part = place - corner
    indices = np.empty((len(rows), 4), dtype=np.intp)
    weights = np.empty((len(rows), 4))
    for number in range(4):
        step_x, step_y = number % 2, number // 2
        x, y = np.minimum(corner[:, 0] + step_x, width - 1), np.minimum(corner[:, 1] + step_y, height - 1)
        indices[:, number] = y * width + x
        weights[:, number] = np.abs(1 - step_x - part[:, 0]) * np.abs(1 - step_y - part[:, 1])
    limit = SAME_PLACE_PX * compute_pixel_size(points_vs[inside], before.camera, width, height)
    normals = np.asarray(now.normals[rows, columns], dtype=np.float64)
    points_before = before.positions_rel.reshape(-1, 3)
    counted = before.comparable.reshape(-1)
    same = np.ones(len(rows), dtype=bool)
    for number in range(4):
        index = indices[:, number]
        gap = (points_before[index] - points_rel) + (before.origin_ws - now.origin_ws)
        fits = counted[index] & (np.abs(np.einsum("ij,ij->i", gap, normals)) <= limit)
        same &= fits | (weights[:, number] == 0)
    return Places(rows[same], columns[same], indices[same], weights[same])


class TemporalSums:
    """Gathers the changes of one layer over the frames of a move."""

    def __init__(self) -> None:
        self._squares = np.zeros(3)  # of Ds - Dt, Ds, Dt
        self._sizes = np.zeros(2)  # of |Ds|, |Dt|
        self._count = 0
        self._block_squares, self._block_count = 0.0, 0

    def add(
        self,
        places: Places,
        layers: tuple[NDArray[np.floating], NDArray[np.floating]],
        truths: tuple[NDArray, NDArray],
    ) -> None:
        """Adds a step: layer and truth (h, w) of the frame before and of this one. What isn't finite counts as 0."""
        changes = []
        for before, now in (layers, truths):
            earlier = np.nan_to_num(np.asarray(before, dtype=np.float64), nan=0.0, posinf=0.0, neginf=0.0)
            later = np.asarray(now[places.rows, places.columns], dtype=np.float64)
            changes.append(np.nan_to_num(later, nan=0.0, posinf=0.0, neginf=0.0) - places.look_up(earlier))
        excess = changes[0] - changes[1]
        self._squares += [np.square(values).sum() for values in (excess, *changes)]
        self._sizes += [np.abs(values).sum() for values in changes]
        self._count += len(excess)
        columns = layers[1].shape[1] // BLOCK_PX + 1
        block = (places.rows // BLOCK_PX) * columns + places.columns // BLOCK_PX
        counts = np.bincount(block)
        # Blocks that are mostly seen: a few pixels are no average.
        full = counts >= BLOCK_PX * BLOCK_PX // 2
        means = np.bincount(block, weights=excess)[full] / counts[full]
        self._block_squares += float(np.square(means).sum())
        self._block_count += int(full.sum())

    def compute(self) -> dict[str, float | None]:
        """Values by the ids of TEMPORAL_MEASURES; None: undefined, as where no place is seen twice."""
        values: dict[str, float | None] = {info.id: None for info in TEMPORAL_MEASURES}
        if self._count:
            rms = np.sqrt(self._squares / self._count)
            values.update(
                temporal_rms=float(rms[0]), temporal_layer_rms=float(rms[1]), temporal_truth_rms=float(rms[2])
            )
        if self._block_count:
            values["temporal_blocks_rms"] = math.sqrt(self._block_squares / self._block_count)
        if self._sizes[1] > 0:
            values["temporal_change_ratio"] = float(self._sizes[0] / self._sizes[1])
        return values

    @property
    def pixel_count(self) -> int:
        """Pixels in all steps together."""
        return self._count
