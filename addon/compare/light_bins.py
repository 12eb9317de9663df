# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles as a light sees them, and which of them lie near a place in its map.

A ray from the light is a vector d = (x, y, z), of any length, in the light space of a view; of a sun (x, y, 1), where x
and y are the ray's place. With the corners v0, v1, v2 of a triangle written the same way, e_i(d) = d . (v_j x v_k) is
the weight of corner i where the ray meets the triangle's plane: inside it all three are of one sign, and any value that
is linear over the triangle is sum(e_i value_i) / sum(e_i). All of it is linear in d, so what holds at the corners of a
convex set of rays holds in all of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .footprint import compute_tangents

# What lies nearer to the light than this part of the farthest receiver's distance isn't found.
NEAREST_PART = 1e-7
# Bounds of the memory: cells in each direction, and entries in all of them together.
MOST_CELLS = 1024
MOST_ENTRIES = 12_000_000


@dataclass(frozen=True)
class View:
    """A map's view: MapView in native/include/shadow_layers/request.h."""

    perspective: bool
    texel_size: tuple[float, float]
    view_from_world: NDArray[np.float64]  # (4, 4), rigid

    def transform(self, points_ws: NDArray[np.float64]) -> NDArray[np.float64]:
        """World to light space, (..., 3)."""
        matrix = np.asarray(self.view_from_world, dtype=np.float64)
        # A view's place is subtracted first: scenes far from the origin keep their digits.
        origin_ws = -matrix[:3, :3].T @ matrix[:3, 3]
        return (points_ws - origin_ws) @ matrix[:3, :3].T

    def make_rays(self, points_ls: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rays from the light to points, (..., 3)."""
        if self.perspective:
            return points_ls
        rays = points_ls.copy()
        rays[..., 2] = 1.0
        return rays

    def get_depth(self, rays: NDArray[np.float64]) -> NDArray[np.float64]:
        """By which a ray's x and y are divided to find its place in the map."""
        return -rays[..., 2] if self.perspective else rays[..., 2]


def make_views(kind: str, world_from_light: NDArray[np.float64]) -> list[View]:
    """Views that see all that a light can reach, for squares that don't lie in a map: a sun's, or six faces of a cube.
    `kind`, `world_from_light` as in the snapshot."""
    matrix = np.asarray(world_from_light, dtype=np.float64)
    z = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    x = compute_tangents(z[None, :])[0][0]
    turns = [np.stack([x, np.cross(z, x), z])]
    if kind != "SUN":
        turns = [np.stack([x, y, np.cross(x, y)]) for x in np.eye(3) for y in np.eye(3) if x @ y == 0]
    views = []
    for turn in turns:
        view_from_world = np.eye(4)
        view_from_world[:3, :3] = turn
        view_from_world[:3, 3] = -turn @ matrix[:3, 3]
        views.append(View(kind != "SUN", (0.0, 0.0), view_from_world))
    return views


@dataclass(frozen=True)
class SeenTriangles:
    """Triangles in a view; t of them, those seen edge-on left out."""

    index: NDArray[np.int64]  # (t,) in SceneTriangles
    corners_ls: NDArray[np.float64]  # (t, 3, 3) in light space, wound so that weights inside are positive
    weights: NDArray[np.float64]  # (t, 3, 3): v_j x v_k of each corner
    low: NDArray[np.float64]  # (t, 2) bounds in the map's plane
    high: NDArray[np.float64]
    mirrored: NDArray[np.bool_]  # (t,) the winding was turned round
    normals: NDArray[np.float64]  # (t, 3) unit, in light space, to the side that the light sees


def see_triangles(
    view: View, corners_ws: NDArray[np.float64], index: NDArray[np.int64], farthest: float
) -> SeenTriangles:
    """The triangles `index` of `corners_ws` (n, 3, 3) that lie before the light. `farthest`: depth of the farthest
    receiver."""
    corners_ls = view.transform(corners_ws[index])
    rays = view.make_rays(corners_ls)
    depth = view.get_depth(rays)
    nearest = farthest * NEAREST_PART
    there = (depth > nearest).any(axis=1)
    index, corners_ls, rays, depth = index[there], corners_ls[there], rays[there], depth[there]
    weights = np.stack([np.cross(rays[:, (i + 1) % 3], rays[:, (i + 2) % 3]) for i in range(3)], axis=1)
    volume = np.einsum("ij,ij->i", rays[:, 0], weights[:, 0])
    low, high = bound_triangles(rays, depth, nearest)
    mirrored = volume < 0
    weights[mirrored] *= -1.0
    normals = np.cross(corners_ls[:, 1] - corners_ls[:, 0], corners_ls[:, 2] - corners_ls[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    # Of a sun the volume has the sign of the normal's z, of another light that of the normal's way from the light.
    normals[(volume > 0) if view.perspective else (volume < 0)] *= -1.0
    solid = (volume != 0) & np.isfinite(volume)
    return SeenTriangles(
        index[solid], corners_ls[solid], weights[solid], low[solid], high[solid], mirrored[solid], normals[solid]
    )


def bound_triangles(
    rays: NDArray[np.float64], depth: NDArray[np.float64], nearest: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Bounds (t, 2) in the map's plane of the parts of triangles (t, 3, 3) that are deeper than `nearest`."""
    before = depth > nearest
    place = rays[..., :2] / np.where(before, depth, 1.0)[..., None]
    low = np.where(before[..., None], place, np.inf).min(axis=1)
    high = np.where(before[..., None], place, -np.inf).max(axis=1)
    for i in range(3):
        j = (i + 1) % 3
        cut = np.flatnonzero(before[:, i] != before[:, j])
        part = (nearest - depth[cut, i]) / (depth[cut, j] - depth[cut, i])
        met = (rays[cut, i, :2] + part[:, None] * (rays[cut, j, :2] - rays[cut, i, :2])) / nearest
        low[cut], high[cut] = np.minimum(low[cut], met), np.maximum(high[cut], met)
    return low, high


class LightBins:
    """A grid over places in a map's plane. Each cell lists the triangles whose bounds, grown by `reach` (2,), touch it:
    all that can touch a rectangle that reaches so far, or less, round any place in the cell. `entries`: rows of the
    seen triangles, cell by cell; `low`, `high`: their bounds."""

    def __init__(
        self, seen: SeenTriangles, low: NDArray[np.float64], high: NDArray[np.float64], reach: NDArray
    ) -> None:
        near = ((seen.high >= low - reach) & (seen.low <= high + reach)).all(axis=1)
        self._row_of = np.flatnonzero(near)
        self._low = low
        grown_low, grown_high = seen.low[near] - reach, seen.high[near] + reach
        size = np.maximum(high - low, 1e-300)
        self._counts = np.clip(size / np.maximum(reach, size / MOST_CELLS), 1, MOST_CELLS).astype(np.int64)
        while True:
            self._cell = size / self._counts
            start, end = self._find_cells(grown_low), self._find_cells(grown_high)
            spans = end - start + 1
            total = int(spans.prod(axis=1).sum())
            if total <= MOST_ENTRIES or (self._counts == 1).all():
                break
            self._counts = np.maximum(self._counts // 2, 1)
        amounts = spans.prod(axis=1)
        rows = np.repeat(np.arange(len(spans), dtype=np.int32), amounts)
        step = np.arange(total, dtype=np.int32) - np.repeat((np.cumsum(amounts) - amounts).astype(np.int32), amounts)
        across = spans[rows, 0].astype(np.int32)
        columns, lines = start[:, 0].astype(np.int32)[rows], start[:, 1].astype(np.int32)[rows]
        cells = (lines + step // across) * np.int32(self._counts[0]) + columns + step % across
        order = np.argsort(cells, kind="stable")
        self.entries = self._row_of[rows[order]]
        self._first = np.searchsorted(cells[order], np.arange(int(self._counts.prod()) + 1))
        # In the entries' order: they are read one after another.
        self.low, self.high = seen.low[self.entries], seen.high[self.entries]

    def _find_cells(self, places: NDArray[np.float64]) -> NDArray[np.int64]:
        """Column and row of each place (n, 2), those outside in the nearest cell."""
        scaled = np.clip((places - self._low) / self._cell, 0.0, (self._counts - 1).astype(np.float64))
        return np.floor(scaled).astype(np.int64)

    def find(self, places: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """For each place (n, 2) where its triangles start in `entries`, and how many there are."""
        cells = self._find_cells(places) @ np.array([1, self._counts[0]])
        return self._first[cells], self._first[cells + 1] - self._first[cells]
