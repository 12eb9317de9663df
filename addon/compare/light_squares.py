# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The squares round receivers that the filtered truth averages over, as a light sees them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .footprint import compute_tangents
from .light_bins import View
from .scene_triangles import SceneTriangles


@dataclass(frozen=True)
class Footprint:
    """The square: its side in texels of the map, or, if that is 0, in scene units on the receiver's plane."""

    texels: float = 0.0
    world: float = 0.0


@dataclass(frozen=True)
class Receivers:
    """Pixels whose truth is wanted, n of them: their points, and the triangles that they lie on."""

    points_ws: NDArray[np.float64]  # (n, 3)
    triangle: NDArray[np.int64]  # (n,) in SceneTriangles
    pixel: NDArray[np.int64]  # (n,) any number of its own: decides where its samples lie


@dataclass(frozen=True)
class LightSquares:
    """Receivers in a view: planes, and the rays d0 + a d1 + b d2 with a and b from -1/2 to 1/2."""

    points_ls: NDArray[np.float64]  # (n, 3)
    normals_ls: NDArray[np.float64]  # (n, 3) unit, towards the light
    d0: NDArray[np.float64]
    d1: NDArray[np.float64]
    d2: NDArray[np.float64]
    place: NDArray[np.float64]  # (n, 2) in the map's plane
    half: NDArray[np.float64]  # (n, 2) half the size of the square's bounds; infinite: it reaches behind the light
    triangle: NDArray[np.int64]
    rounding: NDArray[np.float64]

    def take(self, rows: NDArray) -> LightSquares:
        return LightSquares(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def make_squares(
    view: View, triangles: SceneTriangles, receivers: Receivers, rows: NDArray[np.int64], footprint: Footprint
) -> LightSquares:
    """The squares of some receivers in their view."""
    triangle = receivers.triangle[rows]
    corners_ls = view.transform(triangles.corners_ws[triangle])
    normals = np.cross(corners_ls[:, 1] - corners_ls[:, 0], corners_ls[:, 2] - corners_ls[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    points_ls = view.transform(receivers.points_ws[rows])
    # The picture's positions are rounded to float32: back onto the plane.
    off = np.einsum("ij,ij->i", normals, points_ls - corners_ls[:, 0])
    points_ls = points_ls - off[:, None] * normals
    to_light = -points_ls if view.perspective else np.array([0.0, 0.0, 1.0])
    normals *= np.where(np.einsum("ij,ij->i", normals, np.broadcast_to(to_light, normals.shape)) < 0, -1.0, 1.0)[
        :, None
    ]

    d0 = view.make_rays(points_ls)
    depth = np.maximum(view.get_depth(d0), 1e-300)
    place = d0[:, :2] / depth[:, None]
    d1, d2 = np.zeros_like(d0), np.zeros_like(d0)
    if footprint.texels > 0:
        d0 = d0 / depth[:, None]
        d1[:, 0], d2[:, 1] = (footprint.texels * size for size in view.texel_size)
    elif footprint.world > 0:
        tangents = compute_tangents(normals)
        d1, d2 = (footprint.world * tangent for tangent in tangents)
        if not view.perspective:
            d1[:, 2] = d2[:, 2] = 0.0
    half = np.zeros_like(place)
    for a, b in ((-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)):
        corner = d0 + a * d1 + b * d2
        w = view.get_depth(corner)
        before = w > 1e-3 * np.abs(view.get_depth(d0))
        at = corner[:, :2] / np.where(before, w, 1.0)[:, None]
        half = np.maximum(half, np.where(before[:, None], np.abs(at - place), np.inf))
    return LightSquares(points_ls, normals, d0, d1, d2, place, half, triangle, triangles.rounding[triangle])


def group_by_size(squares: LightSquares) -> list[NDArray[np.int64]]:
    """Rows of squares of about one size, so that a grid fits all of them."""
    size = squares.half.max(axis=1)
    finite = np.isfinite(size)
    octave = np.full(len(size), 2000, dtype=np.int64)
    octave[finite] = np.maximum(np.ceil(np.log2(np.maximum(size[finite], 1e-300))), -1000).astype(np.int64)
    # A few neighbouring octaves share a grid: fewer grids, each a little coarser.
    return [np.flatnonzero(octave // 2 == value) for value in np.unique(octave // 2)]
