# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The true border of a shadow, finer than a pixel: the 1/2-contour of a truth of several samples per pixel.

Marching squares with linear interpolation between the samples. A truth of zeros and ones is averaged over squares of a
pixel's size first, so that the contour passes between its samples and doesn't run along them in steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEVEL = 0.5
# Sides of the squares that noisy values are averaged over, in pixels.
NOISE_SIDES = (5, 15)
# Corners of a cell of four samples, counter-clockwise from the lower left, and its edges between them.
CORNERS_XY = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0))


@dataclass(frozen=True)
class Contour:
    """`starts`, `ends` (n, 2): short straight pieces, in pixels: x to the right, y up, the picture's corner at 0, pixel
    centres at +0.5. `normals` (n, 2): unit, towards the larger values."""

    starts: NDArray[np.float64]
    ends: NDArray[np.float64]
    normals: NDArray[np.float64]

    @property
    def middles(self) -> NDArray[np.float64]:
        return 0.5 * (self.starts + self.ends)

    @property
    def lengths_px(self) -> NDArray[np.float64]:
        return np.linalg.norm(self.ends - self.starts, axis=1)


def average_over_pixel(truth: NDArray[np.bool_], samples: int) -> NDArray[np.float32]:
    """Shares of True (h, w) in the square of an odd number of samples, `samples` or one more, about each sample; rows
    and columns beyond the rim repeat the last. Odd, so that no share is exactly one half."""
    side = samples | 1
    counts = truth.astype(np.uint16 if side > 15 else np.uint8)
    for axis in (0, 1):
        widths = [(side // 2, side // 2) if other == axis else (0, 0) for other in (0, 1)]
        padded = np.pad(counts, widths, mode="edge")
        length = truth.shape[axis]
        counts = np.zeros_like(counts)
        for offset in range(side):
            counts += padded[offset : offset + length] if axis == 0 else padded[:, offset : offset + length]
    return counts.astype(np.float32) / np.float32(side * side)


def average_values(values: NDArray[np.floating], counted: NDArray[np.bool_], side: int) -> NDArray[np.float64]:
    """Means of the counted values (h, w) in the square of `side` x `side` pixels, odd, about each pixel; pixels that
    aren't counted keep their own."""
    total = _sum_squares(np.where(counted, values, 0.0), side)
    number = _sum_squares(counted, side)
    return np.where(counted, total / np.maximum(number, 1.0), values)


def _sum_squares(picture: NDArray, side: int) -> NDArray[np.float64]:
    """Sums (h, w) over the square about each pixel; nothing lies beyond the rim."""
    for axis in (0, 1):
        widths = [(side // 2 + 1, side // 2) if other == axis else (0, 0) for other in (0, 1)]
        running = np.cumsum(np.pad(picture, widths), axis=axis, dtype=np.float64)
        picture = running[side:] - running[:-side] if axis == 0 else running[:, side:] - running[:, :-side]
    return picture


def smooth_noise(values: NDArray[np.floating], counted: NDArray[np.bool_]) -> NDArray[np.float64]:
    """A truth (h, w) of few samples, averaged so that its contour isn't ragged with noise: over squares of half the
    penumbra's width (the median along the border), 5 to 15 pixels. On straight borders that moves nothing, and a shadow
    has no corners finer than its penumbra."""
    smooth = average_values(values, counted, NOISE_SIDES[0])
    if min(values.shape) < 2:
        return smooth
    steep_y, steep_x = np.gradient(smooth)
    near = counted & (np.abs(smooth - LEVEL) < 0.25)
    steepness = np.hypot(steep_x, steep_y)[near]
    if not (steepness > 0).any():
        return smooth
    width_px = 1.0 / float(np.median(steepness[steepness > 0]))
    side = int(np.clip(width_px / 2, *NOISE_SIDES)) | 1
    return smooth if side == NOISE_SIDES[0] else average_values(values, counted, side)


def trace_contour(truth: NDArray, samples: int = 1) -> Contour:
    """The 1/2-contour of a truth of `samples` x `samples` samples per pixel: (h * samples, w * samples), 0..1 or bool.

    Values that aren't finite count as 0. A picture of one row or column of samples has no contour.
    """
    values = average_over_pixel(truth, samples) if truth.dtype == bool and samples > 1 else truth.astype(np.float32)
    values = np.where(np.isfinite(values), values, np.float32(0.0)) - np.float32(LEVEL)
    inside = values >= 0
    mixed = inside[:-1, :-1] != inside[1:, 1:]
    mixed |= inside[:-1, 1:] != inside[1:, :-1]
    mixed |= inside[:-1, :-1] != inside[:-1, 1:]
    rows, columns = np.nonzero(mixed)
    corners = np.stack(
        [values[rows, columns], values[rows, columns + 1], values[rows + 1, columns + 1], values[rows + 1, columns]], 1
    ).astype(np.float64)
    cells, starts, ends = cut_cells(corners)
    # The sample (row, column) lies at (column + 0.5) / samples pixels.
    origin = np.stack([columns, rows], axis=1)[cells] + 0.5
    starts, ends = (starts + origin) / samples, (ends + origin) / samples
    along = ends - starts
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1)
    a, b, c, d = corners[cells].T
    gradient = np.stack([b + c - a - d, c + d - a - b], axis=1)
    normals *= np.where(np.einsum("ij,ij->i", normals, gradient) < 0, -1.0, 1.0)[:, None]
    length = np.linalg.norm(normals, axis=1)
    kept = length > 0
    return Contour(starts[kept], ends[kept], normals[kept] / length[kept, None])


def cut_cells(
    corners: NDArray[np.float64],
) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    """Pieces of the zero contour in cells with corner values (n, 4), counter-clockwise from the lower left: the cell
    of each piece (m,) and its ends (m, 2) in cell units. A saddle is cut so that its middle keeps its sign."""
    points = np.empty((len(corners), 4, 2))
    crossed = np.empty((len(corners), 4), dtype=bool)
    for edge, (first, second) in enumerate(EDGES):
        one, other = corners[:, first], corners[:, second]
        crossed[:, edge] = (one >= 0) != (other >= 0)
        step = np.where(crossed[:, edge], one / np.where(one == other, 1.0, one - other), 0.0)
        points[:, edge] = CORNERS_XY[first] + step[:, None] * (CORNERS_XY[second] - CORNERS_XY[first])
    crossings = crossed.sum(axis=1)
    simple = np.nonzero(crossings == 2)[0]
    order = np.argsort(~crossed[simple], axis=1, kind="stable")
    saddle = np.nonzero(crossings == 4)[0]
    # Edges 0 and 1 enclose corner 1, which is cut off if the middle is of the other sign.
    cuts_corner_1 = (corners[saddle].mean(axis=1) >= 0) != (corners[saddle, 1] >= 0)
    partner = np.where(cuts_corner_1, 1, 3)
    cells = np.concatenate([simple, saddle, saddle])
    starts = np.concatenate([points[simple, order[:, 0]], points[saddle, 0], points[saddle, 2]])
    ends = np.concatenate([points[simple, order[:, 1]], points[saddle, partner], points[saddle, 4 - partner]])
    return cells, starts, ends
