# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact Euclidean distances in a picture, in NumPy alone (SciPy isn't in Blender)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Larger than any picture; its square still fits an int64 many times over.
NO_TARGET = 1 << 24


def compute_nearest_distance(
    targets: NDArray[np.bool_], rows: NDArray[np.integer], columns: NDArray[np.integer]
) -> NDArray[np.float64]:
    """Distance in pixels from the centres of the pixels (rows, columns) to the centre of the nearest target pixel.

    `targets` (h, w); `rows` and `columns` (n,). Returns (n,); infinity where the picture has no target.

    The distance separates: the nearest target within each column is found for the whole picture by two running
    extrema, then each query looks sideways, column by column, and stops as soon as the sideways step alone is longer
    than the best distance found. So it costs in proportion to the queries and to their distances, and is exact.
    """
    height, width = targets.shape
    row_index = np.arange(height, dtype=np.int64)[:, None]
    last_below = np.maximum.accumulate(np.where(targets, row_index, -NO_TARGET), axis=0)
    next_above = np.minimum.accumulate(np.where(targets, row_index, NO_TARGET)[::-1], axis=0)[::-1]
    vertical_squared = np.minimum(row_index - last_below, next_above - row_index) ** 2
    del last_below, next_above

    rows = np.asarray(rows, dtype=np.int64)
    columns = np.asarray(columns, dtype=np.int64)
    if not targets.any():
        return np.full(rows.shape, np.inf)
    best_squared = vertical_squared[rows, columns]
    active = np.arange(rows.size)
    for offset in range(1, width):
        active = active[best_squared[active] > offset * offset]
        if active.size == 0:
            break
        for side in (-offset, offset):
            column = columns[active] + side
            inside = (column >= 0) & (column < width)
            chosen = active[inside]
            candidate = vertical_squared[rows[chosen], column[inside]] + offset * offset
            best_squared[chosen] = np.minimum(best_squared[chosen], candidate)
    return np.sqrt(best_squared.astype(np.float64))
