# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sorting the pixels where a layer and Cycles' hard truth differ by cause, for the batch's verb compare."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .capture import CapturedFrame, CapturedLayer
from .compare.measures import LIT_THRESHOLD
from .compare.plain_rays import TriangleRays
from .compare.scene_triangles import find_casters, gather_triangles
from .compare.wrong_causes import CAUSES, CauseSorter, make_wrong_pixels
from .snapshot import INSTANCE_CAMERA

LISTED_PIXELS = 1000


class CauseSource:
    """Causes in one frame. `truth_points` (h, w, 3): where Cycles' rays meet the surface, relative to the camera.
    `most`: wrong pixels that are sorted of each layer; if it has more, that many spread over all of them. Of the aux
    pictures `captured` must have "ids"."""

    def __init__(self, captured: CapturedFrame, truth_points: NDArray[np.float64], most: int) -> None:
        self._captured, self._truth_points, self._most = captured, truth_points, most
        self._origin_ws = np.asarray(captured.camera_position, dtype=np.float64)
        self._triangles = gather_triangles(captured.snapshot)
        flags = captured.snapshot.instance_flags[self._triangles.instance]
        seen = np.flatnonzero((flags & INSTANCE_CAMERA) != 0)
        self._seen = TriangleRays(self._triangles, seen, self._origin_ws)
        self._sorters: dict[int, CauseSorter] = {}

    def describe(
        self, layer: CapturedLayer, truth_lit: NDArray[np.bool_], comparable: NDArray[np.bool_]
    ) -> dict[str, Any]:
        """What a record says of a layer's wrong pixels: how many there are and how many were sorted, their number by
        cause, the farthest that Cycles looked beside a centre where that is the cause, and the pixels themselves."""
        layer_lit = layer.channels["visibility"] >= LIT_THRESHOLD
        rows, columns = np.nonzero((layer_lit != truth_lit) & comparable)
        count = len(rows)
        if count > self._most:
            chosen = np.linspace(0, count - 1, self._most).astype(np.int64)
            rows, columns = rows[chosen], columns[chosen]
        snapshot = self._captured.snapshot
        ids = self._captured.aux["ids"][rows, columns]
        pixels = make_wrong_pixels(
            rows, columns,
            layer_triangles=self._triangles.find_triangles(ids[:, 0], ids[:, 1]),
            layer_lit=layer_lit[rows, columns], truth_lit=truth_lit[rows, columns],
            truth_points=self._truth_points[rows, columns],
            camera=snapshot.camera, width=snapshot.render.width, height=snapshot.render.height,
        )  # fmt: skip
        causes = self._get_sorter(layer.job.light).sort(pixels)
        counts = Counter(causes)
        beside = [px for px, cause in zip(pixels.truth_offsets_px, causes, strict=True) if cause in ("place", "edge")]
        return {
            "wrong": count,
            "sorted": len(rows),
            "counts": {cause: counts[cause] for cause in CAUSES},
            "farthest_place_px": round(float(max(beside, default=0.0)), 6),
            "pixels": [
                [int(column), int(row), cause]
                for column, row, cause in list(zip(columns, rows, causes, strict=True))[:LISTED_PIXELS]
            ],
        }

    def _get_sorter(self, light_index: int) -> CauseSorter:
        if light_index not in self._sorters:
            snapshot = self._captured.snapshot
            light = snapshot.lights[light_index]
            self._sorters[light_index] = CauseSorter(
                self._triangles,
                seen=self._seen,
                casters=find_casters(self._triangles, snapshot, light),
                light=light,
                origin_ws=self._origin_ws,
                depths=(snapshot.camera.clip_start, snapshot.camera.clip_end),
            )
        return self._sorters[light_index]
