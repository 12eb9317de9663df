# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The true border of a light's shadow: its pieces sorted into the picture's pixels, and where it is a shadow's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .contour import Contour
from .distance import find_nearest_target

# Neighbours whose planes are both farther than this from the other's point lie on two surfaces, and a border between
# them is no shadow's.
TORN_PX = 2.0


@dataclass(frozen=True)
class Nearest:
    """For n pixels: index of the nearest piece of the true border (-1: none) and the distance to it, in pixels."""

    piece: NDArray[np.intp]
    distance_px: NDArray[np.float64]

    def at(self, chosen: NDArray[np.bool_]) -> Nearest:
        return Nearest(self.piece[chosen], self.distance_px[chosen])


class TrueBorder:
    """A light's true border, sorted into pixels. Serves all layers of the light.

    `contour`: of the whole picture's truth; `usable` (h, w): pixels in which a border is the shadow's (see
    `find_usable`). `lit` (h, w): on which side of it the pixels' centres lie, if that isn't what the truth itself says
    (where it is noisy).
    """

    def __init__(self, contour: Contour, usable: NDArray[np.bool_], lit: NDArray[np.bool_] | None = None) -> None:
        self.lit = lit
        height, width = usable.shape
        columns, rows = np.floor(contour.middles).astype(np.int64).T
        pixel = np.clip(rows, 0, height - 1) * width + np.clip(columns, 0, width - 1)
        order = np.argsort(pixel, kind="stable")
        self.starts, self.ends, self.normals = contour.starts[order], contour.ends[order], contour.normals[order]
        self.lengths_px = contour.lengths_px[order]
        self.rows, self.columns = np.divmod(pixel[order], width)
        self.usable = usable[self.rows, self.columns]
        counts = np.bincount(pixel, minlength=height * width)
        self._counts, self._firsts = counts.reshape(height, width), (np.cumsum(counts) - counts).reshape(height, width)
        self.shape = (height, width)

    @property
    def pixels(self) -> NDArray[np.bool_]:
        """(h, w) pixels that hold a piece."""
        return self._counts > 0

    def find_nearest(self, rows: NDArray[np.integer], columns: NDArray[np.integer], limit_px: float) -> Nearest:
        """The nearest piece to the centres of the pixels (rows, columns), (n,) each, if it is within the limit: among
        the pieces in the 5 x 5 pixels about the nearest pixel that holds one."""
        height, width = self.shape
        _, near_rows, near_columns = find_nearest_target(self.pixels, rows, columns, limit_px + 1.0)
        best = np.full(len(rows), np.inf)
        piece = np.full(len(rows), -1)
        found = np.nonzero(near_rows >= 0)[0]
        for step_y in (0, -1, 1, -2, 2):
            for step_x in (0, -1, 1, -2, 2):
                row, column = near_rows[found] + step_y, near_columns[found] + step_x
                inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
                queries, row, column = found[inside], row[inside], column[inside]
                count, first = self._counts[row, column], self._firsts[row, column]
                for number in range(int(count.max(initial=0))):
                    has = count > number
                    candidate = first[has] + number
                    distance = self._compute_distance(candidate, rows[queries[has]], columns[queries[has]])
                    closer = distance < best[queries[has]]
                    target = queries[has][closer]
                    best[target], piece[target] = distance[closer], candidate[closer]
        piece[best > limit_px] = -1
        return Nearest(piece, best)

    def _compute_distance(
        self, piece: NDArray[np.integer], rows: NDArray[np.integer], columns: NDArray[np.integer]
    ) -> NDArray[np.float64]:
        start, along = self.starts[piece], self.ends[piece] - self.starts[piece]
        to_point = np.stack([columns + 0.5, rows + 0.5], axis=1) - start
        step = np.einsum("ij,ij->i", to_point, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
        return np.linalg.norm(to_point - np.clip(step, 0.0, 1.0)[:, None] * along, axis=1)


def shift_picture(picture: NDArray, step_y: int, step_x: int) -> NDArray:
    """The picture's neighbour at (row + step_y, column + step_x) of every pixel; the rim repeats."""
    rows = np.clip(np.arange(picture.shape[0]) + step_y, 0, picture.shape[0] - 1)
    columns = np.clip(np.arange(picture.shape[1]) + step_x, 0, picture.shape[1] - 1)
    return picture[rows][:, columns]


def erode(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Pixels whose 3 x 3 neighbourhood is all in the mask."""
    across = mask & shift_picture(mask, 0, -1) & shift_picture(mask, 0, 1)
    return across & shift_picture(across, -1, 0) & shift_picture(across, 1, 0)


def dilate(mask: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Pixels with one of the mask within `reach` rows and columns."""
    for axis in (0, 1):
        widths = [(reach + 1, reach) if other == axis else (0, 0) for other in (0, 1)]
        sums = np.cumsum(np.pad(mask, widths), axis=axis, dtype=np.int32)
        side = 2 * reach + 1
        mask = (sums[side:] - sums[:-side]) > 0 if axis == 0 else (sums[:, side:] - sums[:, :-side]) > 0
    return mask


def find_usable(
    comparable: NDArray[np.bool_],
    positions_rel: NDArray[np.floating],
    normals: NDArray[np.floating],
    pixel_sizes: NDArray[np.floating],
) -> NDArray[np.bool_]:
    """Pixels (h, w) in which the truth's border is that of a shadow on one surface: all of their 3 x 3 pixels are
    compared, and neighbours lie on one surface or meet at a crease. `positions_rel`, `normals` (h, w, 3);
    `pixel_sizes` (h, w) world size of a pixel there."""
    whole = np.ones(comparable.shape, dtype=bool)
    normals = np.asarray(normals, dtype=np.float64)
    positions = np.asarray(positions_rel, dtype=np.float64)
    for step_y, step_x in ((0, 1), (1, 0)):
        gap = shift_picture(positions, step_y, step_x) - positions
        mine = np.abs(np.einsum("ijk,ijk->ij", gap, normals))
        theirs = np.abs(np.einsum("ijk,ijk->ij", gap, shift_picture(normals, step_y, step_x)))
        # At a crease one of the two planes may run along the view; where a surface ends, neither comes near.
        together = np.minimum(mine, theirs) <= TORN_PX * pixel_sizes
        whole &= together & shift_picture(together, -step_y, -step_x)
    return erode(comparable & whole)
