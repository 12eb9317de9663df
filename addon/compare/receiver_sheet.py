# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a receiver's own surface is near it, and where it lies buried.

Its own surface is what is connected with its triangle inside the square and shows the light the same side. Where that
has ended, the receiver's plane goes on, so that shadows that fall across its rim go on as well. But where the plane
runs into another surface, as the side of a box into the ground, nothing can light it, and nobody can see it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .light_bins import SeenTriangles
from .scene_triangles import SceneTriangles

# The surface that is run into goes on over edges flatter than this (30 degrees): over a ground's triangles, but not
# from the top of a box to its sides.
LEAST_SMOOTH_COSINE = 0.866


@dataclass(frozen=True)
class Surfaces:
    """Of pairs of a pixel and a triangle: which belong to the receiver's own surface, and which to another one that its
    plane runs into. Found only for pixels where it matters."""

    own: NDArray[np.bool_]
    met: NDArray[np.bool_]


def find_surfaces(
    triangles: SceneTriangles,
    seen: SeenTriangles,
    row: NDArray[np.int64],
    seen_row: NDArray[np.int64],
    *,
    receiver: NDArray[np.int64],
    before: NDArray[np.bool_],
    meets: NDArray[np.bool_],
) -> Surfaces:
    """For pairs of a pixel (`row`) and a triangle that touches its square (`seen_row`), all of a pixel's together.
    `receiver`: the triangle that the pixel shows. `before`: it can lie before the receiver's plane. `meets`: it does,
    and passes through that plane in the square.
    """
    own, met = np.zeros(len(row), dtype=bool), np.zeros(len(row), dtype=bool)
    index = seen.index[seen_row]
    is_receiver = index == receiver
    same = triangles.instance[index] == triangles.instance[receiver]
    wanted = np.isin(row, np.unique(row[before & ~is_receiver & (same | meets)]))
    at = np.flatnonzero(wanted & same)
    own[at] = flood(triangles, seen, row[at], seen_row[at], is_receiver[at], smooth_only=False)
    starts = meets & ~own
    at = np.flatnonzero(np.isin(row, np.unique(row[starts])) & ~own)
    met[at] = flood(triangles, seen, row[at], seen_row[at], starts[at], smooth_only=True)
    return Surfaces(own, met)


def flood(
    triangles: SceneTriangles,
    seen: SeenTriangles,
    row: NDArray[np.int64],
    seen_row: NDArray[np.int64],
    reached: NDArray[np.bool_],
    *,
    smooth_only: bool,
) -> NDArray[np.bool_]:
    """The pairs that can be reached from those `reached`, each pixel by itself, over edges that triangles share while
    both show the light the same side."""
    if not reached.any():
        return reached
    index, mirrored = seen.index[seen_row], seen.mirrored[seen_row]
    count = len(triangles.instance)
    key = row * count + index
    order = np.argsort(key)
    sorted_key = key[order]
    links = np.full((len(row), 3), -1, dtype=np.int64)
    for corner in range(3):
        neighbour = triangles.neighbour[index, corner]
        place = order[np.minimum(np.searchsorted(sorted_key, row * count + neighbour), len(order) - 1)]
        there = (neighbour >= 0) & (key[place] == row * count + neighbour)
        # Wound alike, two triangles on the same side run along their edge in opposite directions.
        there &= (mirrored == mirrored[place]) != triangles.same_way[index, corner]
        if smooth_only:
            cosine = np.einsum("ij,ij->i", seen.normals[seen_row], seen.normals[seen_row[place]])
            there &= cosine > LEAST_SMOOTH_COSINE
        links[:, corner] = np.where(there, place, -1)
    while True:
        across = (reached[links] & (links >= 0)).any(axis=1) | reached
        if (across == reached).all():
            return reached
        reached = across
