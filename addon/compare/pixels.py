# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pixels of a layer can be compared with the truth, and why the others can't."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .footprint import compute_view_positions

# Causes of exclusion in the order they are tested; a pixel is counted under the first that holds.
ALL_GROUPS = 0xFFFFFFFFFFFFFFFF  # a light without light linking

EXCLUSION_CAUSES = ("background", "not_same_surface", "faces_away", "outside_cone", "not_linked", "unlit")
COMPARABLE = len(EXCLUSION_CAUSES)

# Both renderers look through the pixel's centre, Cycles within 0.002 pixels of it, so on the same face both points lie
# in one plane but for rounding; at a crease they may differ by that 0.002 of a pixel. A twentieth of a pixel leaves
# room for both and is far below what parts two surfaces that a viewer tells apart.
SURFACE_TOLERANCE_PX = 0.05
# Cycles holds positions as float32 in world axes: a few roundings of the largest coordinate involved.
SURFACE_TOLERANCE_ULPS = 16.0 * float(np.finfo(np.float32).eps)
# Sine of the angle between light and face below which float32 can't say on which side the light is (0.06 degrees).
GRAZING_SINE = 1e-3
# The rim of a cone belongs to neither side: relative width, of the order of float32's error in the cosine.
CONE_RIM = 1e-5


@dataclass(frozen=True)
class Surface:
    """What one renderer sees through the pixels' centres, row 0 at the bottom."""

    positions_rel: NDArray[np.floating]  # (h, w, 3) world axes, relative to the camera's position
    covered: NDArray[np.bool_]  # (h, w) False: background


@dataclass(frozen=True)
class PixelClasses:
    """`cause` (h, w) uint8: index into EXCLUSION_CAUSES, or COMPARABLE."""

    cause: NDArray[np.uint8]

    @property
    def comparable(self) -> NDArray[np.bool_]:
        return self.cause == COMPARABLE

    @property
    def facing_away(self) -> NDArray[np.bool_]:
        return self.cause == EXCLUSION_CAUSES.index("faces_away")

    def count_excluded(self) -> dict[str, int]:
        """Pixels excluded, by cause."""
        counts = np.bincount(self.cause.ravel(), minlength=COMPARABLE + 1)
        return {name: int(counts[index]) for index, name in enumerate(EXCLUSION_CAUSES)}


def compute_pixel_size(points_vs: NDArray[np.float64], camera: Any, width: int, height: int) -> NDArray[np.float64]:
    """World size of a pixel, across the view, at each view space point (n, 3): (n,). The larger of width and height."""
    left, right, bottom, top = camera.window
    size = max((right - left) / width, (top - bottom) / height)
    return size * np.maximum(-points_vs[:, 2], 0.0) if camera.perspective else np.full(len(points_vs), size)


def find_same_surface(
    ours: Surface, truth: Surface, normals: NDArray[np.floating], *, camera: Any, width: int, height: int
) -> NDArray[np.bool_]:
    """Pixels where both see the same face: the other's point lies in the plane of ours. (h, w); False on background."""
    both = ours.covered & truth.covered
    points_rel = np.asarray(ours.positions_rel, dtype=np.float64)[both]
    others_rel = np.asarray(truth.positions_rel, dtype=np.float64)[both]
    matrix = np.asarray(camera.world_from_camera, dtype=np.float64)
    origin_ws = matrix[:3, 3]
    plane_distance = np.abs(np.einsum("ij,ij->i", others_rel - points_rel, np.asarray(normals, np.float64)[both]))
    pixel_size = compute_pixel_size(compute_view_positions(points_rel, origin_ws, matrix), camera, width, height)
    largest_coordinate = np.maximum(np.abs(others_rel + origin_ws).max(axis=1, initial=0.0), np.abs(origin_ws).max())
    same = np.zeros(both.shape, dtype=bool)
    same[both] = plane_distance <= SURFACE_TOLERANCE_PX * pixel_size + SURFACE_TOLERANCE_ULPS * largest_coordinate
    return same


def find_facing(
    points_rel: NDArray[np.floating],
    normals: NDArray[np.floating],
    origin_ws: NDArray[np.float64],
    light: Any,
) -> NDArray[np.bool_]:
    """Faces (n,) turned to the light by more than a grazing angle. `points_rel`, `normals` (n, 3)."""
    matrix = np.asarray(light.world_from_light, dtype=np.float64)
    normals = np.asarray(normals, dtype=np.float64)
    if light.kind == "SUN":
        return normals @ matrix[:3, 2] > GRAZING_SINE
    to_light = (matrix[:3, 3] - np.asarray(origin_ws, np.float64)) - np.asarray(points_rel, np.float64)
    distance = np.linalg.norm(to_light, axis=1)
    return np.einsum("ij,ij->i", normals, to_light) > GRAZING_SINE * distance


def find_in_cone(points_rel: NDArray[np.floating], origin_ws: NDArray[np.float64], light: Any) -> NDArray[np.bool_]:
    """Points (n, 3) that the light shines towards: inside a spot's cone, before an area light. (n,)."""
    if light.kind not in ("SPOT", "AREA"):
        return np.ones(len(points_rel), dtype=bool)
    points_ls = compute_view_positions(points_rel, origin_ws, np.asarray(light.world_from_light, np.float64))
    if light.kind == "SPOT":  # into the space of the lamp's own scale, where its cone is round
        points_ls = points_ls / np.array([*light.spot_scale, 1.0])
    distance = np.maximum(np.linalg.norm(points_ls, axis=1), 1e-300)
    half_angle = 0.5 * (light.spot_angle if light.kind == "SPOT" else math.pi)
    return -points_ls[:, 2] / distance > math.cos(half_angle) + CONE_RIM


def classify_pixels(
    ours: Surface,
    truth: Surface,
    normals: NDArray[np.floating],
    truth_lit: NDArray[np.bool_],
    *,
    camera: Any,
    width: int,
    height: int,
    light: Any,
) -> PixelClasses:
    """Sorts the pixels of a light's layer by whether, or why not, they can be compared.

    `normals` (h, w, 3): our geometric normals, towards the camera. `truth_lit` (h, w): Cycles sends light there when
    nothing casts shadows. `camera`, `light` as in the snapshot; `width`, `height` of the full picture.
    """
    origin_ws = np.asarray(camera.world_from_camera, dtype=np.float64)[:3, 3]
    same = find_same_surface(ours, truth, normals, camera=camera, width=width, height=height)
    cause = np.full(same.shape, EXCLUSION_CAUSES.index("not_same_surface"), dtype=np.uint8)
    cause[~ours.covered & ~truth.covered] = EXCLUSION_CAUSES.index("background")

    points_rel, normals = ours.positions_rel[same], normals[same]
    linked = light.receiver_set == ALL_GROUPS
    of_same = np.full(len(points_rel), COMPARABLE, dtype=np.uint8)
    # Last to first, so that the first cause that holds stands.
    of_same[~truth_lit[same]] = EXCLUSION_CAUSES.index("unlit" if linked else "not_linked")
    of_same[~find_in_cone(points_rel, origin_ws, light)] = EXCLUSION_CAUSES.index("outside_cone")
    of_same[~find_facing(points_rel, normals, origin_ws, light)] = EXCLUSION_CAUSES.index("faces_away")
    cause[same] = of_same
    return PixelClasses(cause)
