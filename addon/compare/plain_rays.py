# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A few rays against all triangles, one after another, in double: what settles single pixels.

It shares nothing with the core, nor with the filtered truth's bins: every triangle whose bounding sphere a ray comes
near is met by the plain formula. A caster blocks a point by the rules that docs/techniques/exact.md tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .scene_triangles import SceneTriangles

# A neighbour's corner may lie off the plane by this part of its distance: float32 positions of a flat face do.
FLAT_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Near:
    """The triangles that rays about a line can meet."""

    index: NDArray[np.int64]  # (k,) in SceneTriangles
    corners: NDArray[np.float64]  # (k, 3, 3) relative to the origin of the rays


class TriangleRays:
    """Rays against the triangles `index` of a scene. All points are world axes relative to `origin_ws` (3,)."""

    def __init__(self, triangles: SceneTriangles, index: NDArray[np.int64], origin_ws: NDArray[np.float64]) -> None:
        self._index = index
        self._corners = triangles.corners_ws[index] - origin_ws
        self._middles = self._corners.mean(axis=1)
        self._radii = np.linalg.norm(self._corners - self._middles[:, None], axis=2).max(axis=1, initial=0.0)

    def find_near(self, start: NDArray, direction: NDArray, longest: float, reach: float) -> Near:
        """Triangles within `reach` of start + s direction, s from 0 to `longest` (infinity: a ray), and maybe more."""
        to_middle = self._middles - start
        along = np.clip(to_middle @ direction / max(direction @ direction, 1e-300), 0.0, longest)
        off = to_middle - along[:, None] * direction
        rows = np.flatnonzero(np.einsum("ij,ij->i", off, off) <= np.square(self._radii + reach))
        return Near(self._index[rows], self._corners[rows])


def meet(corners: NDArray[np.float64], start: NDArray, direction: NDArray) -> NDArray[np.float64]:
    """Where the line start + s direction meets triangles (k, 3, 3): s (k,), not a number for those it passes by. Rims
    belong to triangles; one that is seen edge-on is met nowhere."""
    a, b, c = (corners[:, k] - start for k in range(3))
    volumes = np.stack([np.cross(b, c) @ direction, np.cross(c, a) @ direction, np.cross(a, b) @ direction])
    inside = ((volumes >= 0).all(axis=0) | (volumes <= 0).all(axis=0)) & (volumes.sum(axis=0) != 0)
    normals = np.cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.einsum("ij,ij->i", a, normals) / (normals @ direction)
    return np.where(inside & np.isfinite(distance), distance, np.nan)


def find_first(near: Near, start: NDArray, direction: NDArray, nearest: float, farthest: float) -> int:
    """Row in `near` of the first triangle met between the two distances; -1: none."""
    distance = meet(near.corners, start, direction)
    there = (distance >= nearest) & (distance <= farthest)  # False where it isn't a number
    return int(np.argmin(np.where(there, distance, np.inf))) if there.any() else -1


def find_in_plane(corners: NDArray[np.float64], start: NDArray, direction: NDArray) -> NDArray[np.float64]:
    """Where the line meets the plane of a triangle (3, 3); not finite if it runs along it."""
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    with np.errstate(divide="ignore", invalid="ignore"):
        return start + direction * (normal @ (corners[0] - start) / (normal @ direction))


def find_flat_neighbours(corners: NDArray[np.float64], own: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which triangles (k, 3, 3) are `own` (3, 3) itself, or share an edge with it and lie in its plane."""
    shared = (corners[:, :, None] == own).all(axis=3).any(axis=2)
    normal = np.cross(own[1] - own[0], own[2] - own[0])
    reach = np.where(shared[:, :, None], 0.0, corners - own[0]).sum(axis=1)
    height = np.abs(reach @ normal)
    flat = height <= FLAT_TOLERANCE * np.linalg.norm(normal) * np.linalg.norm(reach, axis=1)
    count = shared.sum(axis=1)
    return (count == 3) | ((count == 2) & flat)


class Shadows:
    """Which points of a triangle a light's casters block. `origin_ws`: that of all points here."""

    def __init__(
        self, triangles: SceneTriangles, casters: NDArray[np.int64], light: Any, origin_ws: NDArray[np.float64]
    ) -> None:
        self._rays = TriangleRays(triangles, casters, origin_ws)
        matrix = np.asarray(light.world_from_light, dtype=np.float64)
        self._is_sun = light.kind == "SUN"
        self._towards = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
        self._place = matrix[:3, 3] - origin_ws

    def get_way(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """From a point to the light; of a sun with length 1."""
        return self._towards if self._is_sun else self._place - point

    def find_near(self, point: NDArray[np.float64], reach: float) -> Near:
        """The casters that can block points within `reach` of this one."""
        return self._rays.find_near(point, self.get_way(point), np.inf if self._is_sun else 1.0, reach)

    def is_lit(
        self, near: Near, point: NDArray[np.float64], own: NDArray[np.float64], *, shift: NDArray | float = 0.0
    ) -> bool:
        """Whether nothing of `near` lies between a point of the triangle `own` (3, 3) and the light. `shift`: moves
        point and light alike. The triangle itself and its neighbours in its plane don't count."""
        distance = meet(near.corners, point + shift, self.get_way(point))
        blocks = (distance > 0) & (self._is_sun | (distance < 1.0))
        if not blocks.any():
            return True
        return bool(find_flat_neighbours(near.corners[blocks], own).all())
