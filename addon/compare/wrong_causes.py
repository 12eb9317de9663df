# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a layer differs from a hard truth of Cycles, pixel by pixel (docs/measures.md).

For each wrong pixel the exact answer is found anew, by rays in double through the pixel's centre and from there to the
light. Where the layer disagrees with it, the technique is wrong. Where it agrees, Cycles' answer must be told by
what Cycles rounds: its rays are float32.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .plain_rays import Near, Shadows, TriangleRays, find_first, find_in_plane
from .scene_triangles import SceneTriangles

FLOAT_EPS = float(np.finfo(np.float32).eps)
# In the order in which they are tested; docs/measures.md says what each means.
CAUSES = ("ambiguous", "technique", "raster", "place", "edge", "offset", "rounding", "unexplained")
# Positions come as float32 and are put together in double: what hangs on less than this part of the largest coordinate
# has no answer.
AMBIGUOUS = 1e-12
# A shadow ray's ends in Cycles: float32 of the largest coordinate, and of what an instance's matrix does to it.
ROUNDINGS = 16.0
# Cycles moves the start of a shadow ray that would miss its own triangle: 256 steps of each coordinate's float32, or
# this length where the coordinate is small.
OFFSET_STEPS = 256
SMALL_COORDINATE, SMALL_OFFSET = 1.0 / 32.0, 1.0 / 65536.0
DIRECTIONS = 16
# The candidates for a ray are found once for all rays beside it, within so many roundings.
REACH_ROUNDINGS = 1024.0


@dataclass(frozen=True)
class WrongPixels:
    """n of them, in the space of the rays: world axes, relative to an origin. Directions have view depth 1."""

    starts: NDArray[np.float64]  # (n, 3) of the rays through the pixels' centres
    directions: NDArray[np.float64]  # (n, 3)
    truth_starts: NDArray[np.float64]  # (n, 3) of the rays through the points that Cycles found
    truth_directions: NDArray[np.float64]  # (n, 3)
    truth_points: NDArray[np.float64]  # (n, 3) those points
    truth_offsets_px: NDArray[np.float64]  # (n,) how far from the centre they appear in the picture
    layer_triangles: NDArray[np.int64]  # (n,) index of the triangle that the layer took the pixel for
    layer_lit: NDArray[np.bool_]  # (n,)
    truth_lit: NDArray[np.bool_]  # (n,)


def make_wrong_pixels(
    rows: NDArray[np.integer],
    columns: NDArray[np.integer],
    *,
    layer_triangles: NDArray[np.int64],
    layer_lit: NDArray[np.bool_],
    truth_lit: NDArray[np.bool_],
    truth_points: NDArray[np.float64],
    camera: Any,
    width: int,
    height: int,
) -> WrongPixels:
    """Of the pixels (rows, columns), (n,) each; `truth_points` (n, 3) relative to the camera's place, as all that comes
    out; `camera` as in the snapshot, `width`, `height` of the full picture."""
    left, right, bottom, top = camera.window
    axes = np.asarray(camera.world_from_camera, dtype=np.float64)[:3, :3]
    size = np.array([(right - left) / width, (top - bottom) / height])
    centres = np.array([left, bottom]) + (np.stack([columns, rows], axis=1) + 0.5) * size
    points_vs = truth_points @ axes
    seen = points_vs[:, :2] / -points_vs[:, 2:] if camera.perspective else points_vs[:, :2]
    rays = []
    for places in (centres, seen):
        away = np.full((len(places), 1), -1.0)
        if camera.perspective:
            start, direction = np.zeros((len(places), 3)), np.hstack([places, away])
        else:
            start, direction = np.hstack([places, 0.0 * away]), np.hstack([0.0 * places, away])
        rays += [start @ axes.T, direction @ axes.T]
    offsets = np.linalg.norm((seen - centres) / size, axis=1)
    return WrongPixels(*rays, truth_points, offsets, layer_triangles, layer_lit, truth_lit)


@dataclass(frozen=True)
class Point:
    """A point of a surface, with the corners (3, 3) of its triangle."""

    place: NDArray[np.float64]
    corners: NDArray[np.float64]
    triangle: int


def offset_start(point_ws: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where Cycles starts a shadow ray that it moves off its surface; world space, `normal` towards the light."""
    point, normal = point_ws.astype(np.float32), normal.astype(np.float32)
    steps = (np.float32(OFFSET_STEPS) * normal).astype(np.int32)
    moved = (point.view(np.int32) + np.where(point < 0, -steps, steps)).view(np.float32)
    small = point + np.float32(SMALL_OFFSET) * normal
    return np.where(np.abs(point) < SMALL_COORDINATE, small, moved).astype(np.float64)


class CauseSorter:
    """Of one light in one frame. `seen`: the triangles that the camera sees; `casters`: those that cast for the light;
    `depths`: the camera's clip range."""

    def __init__(
        self,
        triangles: SceneTriangles,
        *,
        seen: TriangleRays,
        casters: NDArray[np.int64],
        light: Any,
        origin_ws: NDArray[np.float64],
        depths: tuple[float, float],
    ) -> None:
        self._triangles, self._seen = triangles, seen
        self._depths, self._origin_ws = depths, origin_ws
        self._shadows = Shadows(triangles, casters, light, origin_ws)
        matrix = np.asarray(light.world_from_light, dtype=np.float64)
        self._light_reach = 0.0 if light.kind == "SUN" else float(np.abs(matrix[:3, 3]).max())

    def sort(self, pixels: WrongPixels) -> list[str]:
        """One of CAUSES for each pixel."""
        with ThreadPoolExecutor() as pool:
            return list(pool.map(lambda row: self._find_cause(pixels, row), range(len(pixels.starts))))

    def _find_cause(self, pixels: WrongPixels, row: int) -> str:
        truth_lit = bool(pixels.truth_lit[row])
        centre = self._see(pixels.starts[row], pixels.directions[row])
        if centre is None:  # both renderers saw a surface here: only by a hair
            return "edge"
        beside = self._see(pixels.truth_starts[row], pixels.truth_directions[row])
        scale = self._get_scale(centre.place)
        gap = 0.0 if beside is None else float(np.linalg.norm(beside.place - centre.place))
        near = self._shadows.find_near(centre.place, gap + REACH_ROUNDINGS * FLOAT_EPS * scale)
        lit = self._shadows.is_lit(near, centre.place, centre.corners)
        normal = self._get_normal(centre)
        for step in (-AMBIGUOUS * scale, AMBIGUOUS * scale):
            if self._shadows.is_lit(near, centre.place + step * normal, centre.corners) != lit:
                return "ambiguous"
        if lit != pixels.layer_lit[row]:
            return self._find_own_fault(near, centre, pixels, row)
        if beside is None:
            return "edge"
        if self._shadows.is_lit(near, beside.place, beside.corners) == truth_lit:
            return "place" if beside.triangle == centre.triangle else "edge"
        return self._find_rounding(near, centre, pixels, row)

    def _find_own_fault(self, near: Near, centre: Point, pixels: WrongPixels, row: int) -> str:
        """The layer is wrong: by its shadow, or because it took the pixel for another triangle than its ray meets."""
        taken = int(pixels.layer_triangles[row])
        corners = self._triangles.corners_ws[taken] - self._origin_ws
        place = find_in_plane(corners, pixels.starts[row], pixels.directions[row])
        if taken == centre.triangle or not np.isfinite(place).all():
            return "technique"
        return "raster" if self._shadows.is_lit(near, place, corners) == pixels.layer_lit[row] else "technique"

    def _find_rounding(self, near: Near, centre: Point, pixels: WrongPixels, row: int) -> str:
        """Cycles is wrong, and not by the place that it looked at: by the start of its ray to the light, or by the ray
        itself."""
        truth_lit = bool(pixels.truth_lit[row])
        moved = offset_start(pixels.truth_points[row] + self._origin_ws, self._get_normal(centre)) - self._origin_ws
        if self._shadows.is_lit(near, moved, centre.corners) == truth_lit:
            return "offset"
        way = self._shadows.get_way(centre.place)
        across = np.cross(way, np.eye(3)[np.argmin(np.abs(way))])
        across /= np.linalg.norm(across)
        other = np.cross(way / np.linalg.norm(way), across)
        for part in (0.25, 0.5, 1.0):
            for angle in np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS):
                turned = np.cos(angle) * across + np.sin(angle) * other
                shift = part * ROUNDINGS * FLOAT_EPS * self._get_scale(centre.place) * turned
                if self._shadows.is_lit(near, centre.place, centre.corners, shift=shift) == truth_lit:
                    return "rounding"
        return "unexplained"

    def _see(self, start: NDArray, direction: NDArray) -> Point | None:
        """What a camera's ray meets first."""
        near = self._seen.find_near(start, direction, np.inf, 0.0)
        found = find_first(near, start, direction, *self._depths)
        if found < 0:
            return None
        corners = near.corners[found]
        return Point(find_in_plane(corners, start, direction), corners, int(near.index[found]))

    def _get_normal(self, point: Point) -> NDArray[np.float64]:
        """Unit, towards the light."""
        normal = np.cross(point.corners[1] - point.corners[0], point.corners[2] - point.corners[0])
        normal /= np.linalg.norm(normal)
        return normal if normal @ self._shadows.get_way(point.place) >= 0 else -normal

    def _get_scale(self, place: NDArray[np.float64]) -> float:
        """The largest coordinate that Cycles rounds: the receiver's, the light's, the camera's."""
        return max(
            float(np.abs(place + self._origin_ws).max()), float(np.abs(self._origin_ws).max()), self._light_reach
        )
