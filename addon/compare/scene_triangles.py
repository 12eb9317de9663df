# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""All triangles of a snapshot in one list, in double, with their neighbours: what the filtered truth is cast at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

INSTANCE_SHADOW = 2  # as in snapshot.py
# Float32 positions of a flat mesh lie off its plane by a few roundings of their coordinates: of the three corners of
# the plane's own triangle and of the other one, which lies where the first is extended to.
ROUNDINGS = 8.0 * float(np.finfo(np.float32).eps)


@dataclass(frozen=True)
class SceneTriangles:
    """Triangles of all instances, instance by instance; t of them."""

    corners_ws: NDArray[np.float64]  # (t, 3, 3): triangle, corner, axis
    instance: NDArray[np.int32]  # (t,)
    rounding: NDArray[np.float64]  # (t,) scene units: how far from a common plane float32 may set flat triangles
    neighbour: NDArray[np.int64]  # (t, 3) across the edge from corner k to k + 1; -1: none
    same_way: NDArray[np.bool_]  # (t, 3) both run along that edge in the same direction: they are wound differently
    first: NDArray[np.int64]  # (i + 1,) index of each instance's first triangle

    def find_triangles(self, instance: NDArray[np.integer], triangle: NDArray[np.integer]) -> NDArray[np.int64]:
        """Indices into the list of the triangles with these numbers in their instances."""
        return self.first[instance] + triangle


def find_neighbours(
    positions: NDArray[np.floating], triangles: NDArray[np.integer]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """`neighbour` and `same_way` of a mesh, (t, 3) each. Vertices at the same place are one. Where more than two
    triangles meet at an edge, each has one of the others."""
    count = len(triangles)
    neighbour = np.full((count, 3), -1, dtype=np.int64)
    same_way = np.zeros((count, 3), dtype=bool)
    if count == 0:
        return neighbour, same_way
    # + 0.0: minus zero and zero are one place
    _, welded = np.unique(np.ascontiguousarray(positions) + np.float32(0.0), axis=0, return_inverse=True)
    corners = welded.reshape(-1).astype(np.int64)[triangles]
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((high, low))
    equal = (low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1])
    one, other = order[:-1][equal], order[1:][equal]
    for here, there in ((one, other), (other, one)):
        neighbour.ravel()[here] = there // 3
        same_way.ravel()[here] = start[here] == start[there]
    return neighbour, same_way


def gather_triangles(snapshot: Any) -> SceneTriangles:
    """The triangles of a SceneSnapshot, those of instances that neither cast nor are seen too."""
    links = [find_neighbours(mesh.positions, mesh.triangles) for mesh in snapshot.meshes]
    first = np.zeros(len(snapshot.instance_mesh) + 1, dtype=np.int64)
    corners, rounding, neighbour, same_way = [], [], [], []
    for index, (mesh_index, matrix) in enumerate(zip(snapshot.instance_mesh, snapshot.instance_matrix, strict=True)):
        mesh = snapshot.meshes[mesh_index]
        positions = mesh.positions.astype(np.float64)
        scale = float(np.linalg.norm(matrix[:3, :3], axis=0).max())
        size = float(np.abs(positions).max(initial=0.0))
        count = len(mesh.triangles)
        corners.append((positions @ matrix[:3, :3].T + matrix[:3, 3])[mesh.triangles])
        rounding.append(np.full(count, ROUNDINGS * scale * size))
        of_mesh, way = links[mesh_index]
        neighbour.append(np.where(of_mesh >= 0, of_mesh + first[index], -1))
        same_way.append(way)
        first[index + 1] = first[index] + count
    empty = np.zeros((0, 3))
    return SceneTriangles(
        corners_ws=np.concatenate([*corners, np.zeros((0, 3, 3))]),
        instance=np.repeat(np.arange(len(first) - 1, dtype=np.int32), np.diff(first)),
        rounding=np.concatenate([*rounding, np.zeros(0)]),
        neighbour=np.concatenate([*neighbour, empty.astype(np.int64)]),
        same_way=np.concatenate([*same_way, empty.astype(bool)]),
        first=first,
    )


def find_casters(triangles: SceneTriangles, snapshot: Any, light: Any) -> NDArray[np.int64]:
    """Indices of the triangles that cast shadows from this light."""
    if not light.casts_shadow:
        return np.zeros(0, dtype=np.int64)
    groups = np.array([light.blocker_set >> int(group) & 1 for group in snapshot.instance_blocker_group], dtype=bool)
    casts = groups.reshape(-1) & ((snapshot.instance_flags & INSTANCE_SHADOW) != 0)
    return np.flatnonzero(casts[triangles.instance])
