# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How many pixels a shadow map texel covers at a receiver: the unit in which map techniques may be wrong.

At a surface point the picture and the map are both linear to first order. With two tangents t1, t2 of the surface,
A = d(pixel)/d(t1, t2) and B = d(texel)/d(t1, t2), a step of one texel is M = A inv(B) pixels. Its longest image is the
larger singular value of M, which is the footprint returned here: it holds the stretch of the texel over a slanted
receiver, and the receiver's foreshortening in the picture.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

# A spot wider than this is served by cube faces, because one frustum's texels would be stretched without bound.
WIDEST_CONE_RAD = math.radians(120.0)
# Depths are kept from 0 by this; its square is no 0 either.
SHORTEST = 1e-150


def compute_view_positions(
    points_rel: NDArray[np.floating], origin_ws: NDArray[np.float64], matrix_ws: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Points (n, 3), world axes relative to `origin_ws` (3,), in the local axes of `matrix_ws` (4, 4): (n, 3).

    Both translations are subtracted in double before anything else, so scenes far from the origin keep their digits.
    """
    offset_ws = np.asarray(origin_ws, dtype=np.float64) - matrix_ws[:3, 3]
    return (np.asarray(points_rel, dtype=np.float64) + offset_ws) @ matrix_ws[:3, :3]


def compute_tangents(normals: NDArray[np.floating]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit tangents at right angles for each unit normal (n, 3)."""
    normals = np.asarray(normals, dtype=np.float64)
    # The axis least along the normal never gives a short cross product.
    helper = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    first = np.cross(normals, helper)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    return first, np.cross(normals, first)


def compute_pixel_gradients(
    points_vs: NDArray[np.float64], camera: Any, width: int, height: int
) -> NDArray[np.float64]:
    """d(pixel x, pixel y)/d(view space point): (n, 2, 3). `camera` as in the snapshot; the picture's full size."""
    left, right, bottom, top = camera.window
    scale = np.array([width / (right - left), height / (top - bottom)])
    gradients = np.zeros((len(points_vs), 2, 3))
    if camera.perspective:
        depth = np.maximum(-points_vs[:, 2], SHORTEST)
        gradients[:, 0, 0] = scale[0] / depth
        gradients[:, 1, 1] = scale[1] / depth
        gradients[:, :, 2] = scale * points_vs[:, :2] / depth[:, None] ** 2
    else:
        gradients[:, 0, 0], gradients[:, 1, 1] = scale
    return gradients


def compute_texel_gradients(
    points_ls: NDArray[np.float64], light: Any, map_size: int, sun_extent: float
) -> NDArray[np.float64]:
    """d(texel)/d(light space point): (n, 2, 3). `sun_extent`: the side of the sun's map in scene units."""
    count = len(points_ls)
    gradients = np.zeros((count, 2, 3))
    if light.kind == "SUN":
        gradients[:, 0, 0] = gradients[:, 1, 1] = map_size / max(sun_extent, 1e-300)
        return gradients
    tangents = np.ones(2)
    if light.kind == "SPOT":
        tangents = math.tan(0.5 * light.spot_angle) * np.array(light.spot_scale)
    if light.kind == "SPOT" and tangents.max() <= math.tan(0.5 * WIDEST_CONE_RAD):
        major = np.full(count, 2)
        scales = 0.5 * map_size / tangents
    else:  # a cube face: its axis is the longest component
        major = np.argmax(np.abs(points_ls), axis=1)
        scales = np.full(2, 0.5 * map_size)
    index = np.arange(count)
    along = points_ls[index, major]
    along = np.where(np.abs(along) < 1e-300, 1e-300, along)
    for row, step in enumerate((1, 2)):
        across = (major + step) % 3
        gradients[index, row, across] = scales[row] / np.abs(along)
        gradients[index, row, major] = -scales[row] * points_ls[index, across] / (along * np.abs(along))
    return gradients


def compute_texel_steps(pixel_tangent: NDArray[np.float64], texel_tangent: NDArray[np.float64]) -> NDArray[np.float64]:
    """M = A inv(B), d(pixel)/d(texel), for stacks (n, 2, 2); infinity where B is singular (light along the face)."""
    a, b = pixel_tangent, texel_tangent
    det_b = b[:, 0, 0] * b[:, 1, 1] - b[:, 0, 1] * b[:, 1, 0]
    steps = np.empty(a.shape)
    # A adj(B), divided by det(B) at the very end.
    steps[:, 0, 0] = a[:, 0, 0] * b[:, 1, 1] - a[:, 0, 1] * b[:, 1, 0]
    steps[:, 0, 1] = a[:, 0, 1] * b[:, 0, 0] - a[:, 0, 0] * b[:, 0, 1]
    steps[:, 1, 0] = a[:, 1, 0] * b[:, 1, 1] - a[:, 1, 1] * b[:, 1, 0]
    steps[:, 1, 1] = a[:, 1, 1] * b[:, 0, 0] - a[:, 1, 0] * b[:, 0, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        steps /= det_b[:, None, None]
    steps[det_b == 0.0] = np.inf
    return steps


def compute_singular_values(matrices: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Larger and smaller singular value of a stack (n, 2, 2): (n,) each; infinity where an entry is infinite."""
    m = matrices
    with np.errstate(invalid="ignore"):
        # With p, q the lengths of the parts that turn and that mirror: p + q and |p - q|.
        turning = np.hypot(m[:, 0, 0] + m[:, 1, 1], m[:, 1, 0] - m[:, 0, 1])
        mirroring = np.hypot(m[:, 0, 0] - m[:, 1, 1], m[:, 1, 0] + m[:, 0, 1])
        larger, smaller = 0.5 * (turning + mirroring), 0.5 * np.abs(turning - mirroring)
    infinite = ~np.isfinite(m).all(axis=(1, 2))
    return np.where(infinite, np.inf, larger), np.where(infinite, np.inf, smaller)


def compute_sun_extent(points_rel: NDArray[np.floating], origin_ws: NDArray[np.float64], light: Any) -> float:
    """Side of the square, in scene units, that holds all receivers seen, in the sun's own axes: the largest map a fit
    to the receivers can need. `points_rel` (n, 3)."""
    if len(points_rel) == 0:
        return 0.0
    points_ls = compute_view_positions(points_rel, origin_ws, np.asarray(light.world_from_light, dtype=np.float64))
    return float(np.ptp(points_ls[:, :2], axis=0).max())


def compute_view_gradients(points_ls: NDArray[np.float64], view: Mapping[str, Any]) -> NDArray[np.float64]:
    """As `compute_texel_gradients`, by the core's own words on a map's view: "perspective" and "texel_size" (x, y) in
    the plane (x, y) / -z, or (x, y) where it isn't perspective."""
    gradients = np.zeros((len(points_ls), 2, 3))
    depth = np.maximum(-points_ls[:, 2], SHORTEST) if view["perspective"] else np.ones(len(points_ls))
    for axis, size in enumerate(view["texel_size"]):
        gradients[:, axis, axis] = 1.0 / (depth * size)
        if view["perspective"]:
            gradients[:, axis, 2] = points_ls[:, axis] / (depth**2 * size)
    return gradients


def choose_views(points: Sequence[NDArray[np.float64]]) -> NDArray[np.int64]:
    """Which of a layer's views serves each point, (n,). `points`: the same (n, 3) in the axes of each view. The rule is
    choose_view's in shaders/shared/view_choice.h: the only view, or that of the cube face that the point lies behind,
    along whose axis it lies deepest."""
    if len(points) < 2:
        return np.zeros(len(points[0]) if points else 0, dtype=np.int64)
    return np.argmax(np.stack([-point[:, 2] for point in points]), axis=0)


def compute_texel_tangents(
    points_rel: NDArray[np.floating],
    tangents_ws: NDArray[np.float64],
    origin_ws: NDArray[np.float64],
    views: Sequence[Mapping[str, Any]],
) -> NDArray[np.float64]:
    """B, d(texel)/d(tangents): (n, 2, 2). `tangents_ws` (n, 3, 2); `views` as the core gives them with a layer, with
    "view_from_world" (4, 4)."""
    matrices = [np.asarray(view["view_from_world"], dtype=np.float64) for view in views]
    points_rel = np.asarray(points_rel, dtype=np.float64)
    points = [points_rel @ matrix[:3, :3].T + (matrix[:3, :3] @ origin_ws + matrix[:3, 3]) for matrix in matrices]
    chosen = choose_views(points)
    result = np.empty((len(points_rel), 2, 2))
    for index, (view, matrix, point) in enumerate(zip(views, matrices, points, strict=True)):
        mine = chosen == index
        result[mine] = compute_view_gradients(point[mine], view) @ (matrix[:3, :3] @ tangents_ws[mine])
    return result


def compute_texel_matrices(
    points_rel: NDArray[np.floating],
    normals: NDArray[np.floating],
    origin_ws: NDArray[np.float64],
    *,
    camera: Any,
    width: int,
    height: int,
    light: Any,
    map_size: int,
    sun_extent: float = 0.0,
    views: Sequence[Mapping[str, Any]] = (),
) -> NDArray[np.float64]:
    """M = d(pixel)/d(texel) at each receiver: (n, 2, 2), pixels x to the right and y up.

    `points_rel` (n, 3) world axes relative to `origin_ws` (the camera's position); `normals` (n, 3) unit; `camera` and
    `light` as in the snapshot; `width`, `height` of the full picture. `views`: the map's own, by which M is exact;
    without them the map is taken as large as the light, or as `sun_extent` by `compute_sun_extent`, would need it.
    """
    origin_ws = np.asarray(origin_ws, dtype=np.float64)
    camera_matrix = np.asarray(camera.world_from_camera, dtype=np.float64)
    pixel = compute_pixel_gradients(compute_view_positions(points_rel, origin_ws, camera_matrix), camera, width, height)
    tangents_ws = np.stack(compute_tangents(normals), axis=2)  # (n, 3, 2)
    pixel_tangent = pixel @ (camera_matrix[:3, :3].T @ tangents_ws)
    if views:
        return compute_texel_steps(pixel_tangent, compute_texel_tangents(points_rel, tangents_ws, origin_ws, views))
    light_matrix = np.array(light.world_from_light, dtype=np.float64)
    if light.kind == "POINT":  # its cube lies along the world's axes, however the light is turned
        light_matrix[:3, :3] = np.eye(3)
    texel = compute_texel_gradients(
        compute_view_positions(points_rel, origin_ws, light_matrix), light, map_size, sun_extent
    )
    return compute_texel_steps(pixel_tangent, texel @ (light_matrix[:3, :3].T @ tangents_ws))


def compute_texel_footprint_px(
    points_rel: NDArray[np.floating], normals: NDArray[np.floating], origin_ws: NDArray[np.float64], **view: Any
) -> NDArray[np.float64]:
    """Pixels that one texel of the light's map covers at each receiver, along the direction it is longest in: (n,).
    What else is given as to `compute_texel_matrices`."""
    return compute_singular_values(compute_texel_matrices(points_rel, normals, origin_ws, **view))[0]
