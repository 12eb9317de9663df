# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which triangles near a receiver are its own surface: connected with its triangle, without a fold, in the square."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .light_bins import SeenTriangles
from .scene_triangles import SceneTriangles


def find_sheet(
    triangles: SceneTriangles,
    seen: SeenTriangles,
    row: NDArray[np.int64],
    seen_row: NDArray[np.int64],
    *,
    own: NDArray[np.int64],
    before: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Of pairs of a pixel (`row`) and a triangle that touches its square (`seen_row`), all of a pixel's together:
    whether the triangle belongs to the receiver's surface. `own`: the receiver's triangle. The surface goes on across
    an edge that two triangles share while both show the light the same side. Pixels without a triangle of their
    instance `before` their plane are left out: nothing depends on it.
    """
    sheet = np.zeros(len(row), dtype=bool)
    index = seen.index[seen_row]
    same = triangles.instance[index] == triangles.instance[own]
    wanted = np.unique(row[before & same & (index != own)])
    at = np.flatnonzero(same & np.isin(row, wanted))
    if not len(at):
        return sheet
    count = len(triangles.instance)
    key = row[at] * count + index[at]
    order = np.argsort(key)
    sorted_key = key[order]
    links = np.full((len(at), 3), -1, dtype=np.int64)
    mirrored = seen.mirrored[seen_row[at]]
    for corner in range(3):
        neighbour = triangles.neighbour[index[at], corner]
        place = np.searchsorted(sorted_key, row[at] * count + neighbour)
        place = order[np.minimum(place, len(order) - 1)]
        there = (neighbour >= 0) & (key[place] == row[at] * count + neighbour)
        # Wound alike, two triangles on the same side run along their edge in opposite directions.
        unfolded = (mirrored == mirrored[place]) != triangles.same_way[index[at], corner]
        links[:, corner] = np.where(there & unfolded, place, -1)
    reached = index[at] == own[at]
    while True:
        across = (reached[links] & (links >= 0)).any(axis=1) | reached
        if (across == reached).all():
            break
        reached = across
    sheet[at] = reached
    return sheet
