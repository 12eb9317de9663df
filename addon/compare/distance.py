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
    """
    return find_nearest_target(targets, rows, columns)[0]


def find_nearest_target(
    targets: NDArray[np.bool_], rows: NDArray[np.integer], columns: NDArray[np.integer], limit_px: float = np.inf
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """As `compute_nearest_distance`, with the row and the column of that target (n,); -1 where there is none. Targets
    farther than `limit_px` need not be found: then the distance is infinity.

    The distance separates: the nearest target within each column is found for the whole picture by two running
    extrema, then each query looks sideways, column by column, and stops as soon as the sideways step alone is longer
    than the best distance found. So it costs in proportion to the queries and to their distances, and is exact.
    """
    height, width = targets.shape
    row_index = np.arange(height, dtype=np.int64)[:, None]
    last_below = np.maximum.accumulate(np.where(targets, row_index, -NO_TARGET), axis=0)
    next_above = np.minimum.accumulate(np.where(targets, row_index, NO_TARGET)[::-1], axis=0)[::-1]
    nearest_row = np.where(row_index - last_below <= next_above - row_index, last_below, next_above)
    del last_below, next_above

    rows = np.asarray(rows, dtype=np.int64)
    columns = np.asarray(columns, dtype=np.int64)
    if not targets.any():
        return np.full(rows.shape, np.inf), np.full(rows.shape, -1), np.full(rows.shape, -1)
    best_row, best_column = nearest_row[rows, columns], columns.copy()
    best_squared = (best_row - rows) ** 2
    active = np.arange(rows.size)
    for offset in range(1, width):
        if offset > limit_px:
            break
        active = active[best_squared[active] > offset * offset]
        if active.size == 0:
            break
        for side in (-offset, offset):
            column = columns[active] + side
            inside = (column >= 0) & (column < width)
            chosen, column = active[inside], column[inside]
            row = nearest_row[rows[chosen], column]
            candidate = (row - rows[chosen]) ** 2 + offset * offset
            closer = candidate < best_squared[chosen]
            chosen = chosen[closer]
            best_squared[chosen], best_row[chosen], best_column[chosen] = candidate[closer], row[closer], column[closer]
    distance = np.sqrt(best_squared.astype(np.float64))
    distance[distance > min(limit_px, NO_TARGET // 2)] = np.inf
    found = np.isfinite(distance)
    return distance, np.where(found, best_row, -1), np.where(found, best_column, -1)
