# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The filtered truth: the exact mask of a light without size, averaged over a square round each receiver.

The square lies in the map's plane (its side in texels) or in the receiver's (in scene units). Each of its points stands
for the point of the receiver's plane that the light sees there; that one is in shadow if a triangle lies before it.
The receiver's own surface is no blocker: where its part within the square, connected and turned to the light, rises
before the plane, it takes the plane's place. All in double, from the triangles; no map, no bias (docs/measures.md).

A pixel is decided as a whole where no triangle that touches its square comes before its plane, or one covers it; both
are exact. Elsewhere a fixed number of points is taken, in four lattices shifted anew for each pixel, whose spread gives
the standard error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .footprint import compute_tangents
from .light_bins import LightBins, SeenTriangles, View, see_triangles
from .receiver_sheet import find_sheet
from .sample_points import LATTICES, PixelSamples
from .scene_triangles import SceneTriangles

# Pairs of pixel and triangle at once: what fits the processor's caches, and memory for all their samples.
PAIRS_AT_ONCE = 1 << 17
SAMPLES_AT_ONCE = 1 << 22


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
class FilteredVisibility:
    """For each receiver, 0 to 1, and the standard error of what was sampled."""

    visibility: NDArray[np.float32]  # (n,)
    error: NDArray[np.float32]  # (n,)
    sampled_count: int  # receivers that were not decided as a whole


@dataclass(frozen=True)
class _Squares:
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

    def take(self, rows: NDArray) -> _Squares:
        return _Squares(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def compute_filtered_visibility(
    triangles: SceneTriangles,
    casters: NDArray[np.int64],
    *,
    views: Sequence[View],
    receivers: Receivers,
    footprint: Footprint,
    sample_count: int,
) -> FilteredVisibility:
    """The truth of receivers that face the light. `casters`: the triangles that cast. `views`: of the light's maps, as
    a layer tells them; a receiver belongs to the one in whose pyramid it lies. `sample_count` is rounded up to a
    multiple of four."""
    count = len(receivers.points_ws)
    visibility, error = np.ones(count, np.float32), np.zeros(count, np.float32)
    sampled = 0
    chosen = choose_views(views, receivers.points_ws)
    for number, view in enumerate(views):
        rows = np.flatnonzero(chosen == number)
        if not len(rows) or not len(casters):
            continue
        squares = make_squares(view, triangles, receivers, rows, footprint)
        depth = view.get_depth(view.make_rays(squares.points_ls))
        seen = see_triangles(view, triangles.corners_ws, casters, float(np.abs(depth).max()))
        for group in group_by_size(squares):
            caster = _Caster(triangles, seen, squares.take(group), receivers.pixel[rows[group]], sample_count)
            caster.cast()
            visibility[rows[group]], error[rows[group]] = caster.visibility, caster.error
            sampled += caster.sampled_count
    return FilteredVisibility(visibility, error, sampled)


def choose_views(views: Sequence[View], points_ws: NDArray[np.float64]) -> NDArray[np.int64]:
    """For each point (n, 3) the view whose axis it is nearest to, in the measure of a cube's faces."""
    if len(views) < 2:
        return np.zeros(len(points_ws), dtype=np.int64)
    inside = []
    for view in views:
        points_ls = view.transform(points_ws)
        inside.append(-points_ls[:, 2] - np.abs(points_ls[:, :2]).max(axis=1))
    return np.argmax(inside, axis=0)


def make_squares(
    view: View, triangles: SceneTriangles, receivers: Receivers, rows: NDArray[np.int64], footprint: Footprint
) -> _Squares:
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
    return _Squares(points_ls, normals, d0, d1, d2, place, half, triangle, triangles.rounding[triangle])


def group_by_size(squares: _Squares) -> list[NDArray[np.int64]]:
    """Rows of squares of about one size, so that a grid fits all of them."""
    size = squares.half.max(axis=1)
    finite = np.isfinite(size)
    octave = np.full(len(size), 2000, dtype=np.int64)
    octave[finite] = np.maximum(np.ceil(np.log2(np.maximum(size[finite], 1e-300))), -1000).astype(np.int64)
    # A few neighbouring octaves share a grid: fewer grids, each a little coarser.
    return [np.flatnonzero(octave // 2 == value) for value in np.unique(octave // 2)]


class _Caster:
    """Squares of one view and of about one size."""

    def __init__(
        self, triangles: SceneTriangles, seen: SeenTriangles, squares: _Squares, pixel: NDArray, sample_count: int
    ) -> None:
        self._triangles, self._seen, self._squares = triangles, seen, squares
        self._samples = PixelSamples(pixel, sample_count)
        count = len(pixel)
        self.visibility, self.error = np.ones(count, np.float32), np.zeros(count, np.float32)
        self.sampled_count = 0
        low, high = squares.place.min(axis=0), squares.place.max(axis=0)
        reach = squares.half.max(axis=0)
        if np.isinf(reach).any():
            low, high, reach = np.full(2, -np.inf), np.full(2, np.inf), np.zeros(2)
        self._bins = LightBins(seen, low, high, reach) if np.isfinite(low).all() else None

    def cast(self) -> None:
        """Fills visibility, error and sampled_count."""
        squares, seen = self._squares, self._seen
        if self._bins is None:
            entries = np.arange(len(seen.index))
            first, count = np.zeros(len(squares.place), np.int64), np.full(len(squares.place), len(entries))
        else:
            entries = self._bins.entries
            first, count = self._bins.find(squares.place)
        order = np.argsort(first, kind="stable")
        order = order[count[order] > 0]
        ends = np.cumsum(count[order])
        begin = 0
        while begin < len(order):
            done = ends[begin - 1] if begin else 0
            end = max(begin + 1, int(np.searchsorted(ends, done + PAIRS_AT_ONCE, side="right")))
            rows = order[begin:end]
            counts = count[rows]
            row = np.repeat(rows, counts)
            start = np.repeat(first[rows] - (np.cumsum(counts) - counts), counts)
            self._cast_pairs(row, entries[start + np.arange(len(row))])
            begin = end

    def _cast_pairs(self, row: NDArray[np.int64], seen_row: NDArray[np.int64]) -> None:
        """Pairs of pixel and triangle; all of a pixel's triangles are there, and follow one another."""
        squares, seen = self._squares, self._seen
        touches = (
            (seen.high[seen_row] >= squares.place[row] - squares.half[row])
            & (seen.low[seen_row] <= squares.place[row] + squares.half[row])
        ).all(axis=1)  # fmt: skip
        row, seen_row = row[touches], seen_row[touches]
        edges, low, high = self._compute_edges(row, seen_row)
        touches = (high >= 0).all(axis=1)
        row, seen_row, edges, low = row[touches], seen_row[touches], edges[touches], low[touches]
        # Signed distances of the corners from the receiver's plane, less what rounding can make of a flat surface.
        heights = np.einsum("ikj,ij->ik", seen.corners_ls[seen_row], squares.normals_ls[row])
        heights -= np.einsum("ij,ij->i", squares.points_ls[row], squares.normals_ls[row])[:, None]
        heights -= (self._triangles.rounding[seen.index[seen_row]] + squares.rounding[row])[:, None]
        rise = np.einsum("ikd,ik->id", edges, heights)
        spread = 0.5 * (np.abs(rise[:, 1]) + np.abs(rise[:, 2]))
        before = (heights.max(axis=1) > 0) & (rise[:, 0] + spread > 0)
        sheet = find_sheet(self._triangles, seen, row, seen_row, own=squares.triangle[row], before=before)
        covers = before & ~sheet & (low >= 0).all(axis=1) & (rise[:, 0] - spread > 0)
        has_sheet = np.zeros(len(squares.place), dtype=bool)
        has_sheet[row[sheet & before]] = True
        dark = np.zeros(len(squares.place), dtype=bool)
        # With the surface before the plane, a triangle that covers the square may still lie behind the surface.
        dark[row[covers]] = True
        dark &= ~has_sheet
        self.visibility[dark] = 0.0
        left = before & ~dark[row]
        blocked = np.zeros(len(squares.place), dtype=bool)
        blocked[row[left & ~sheet]] = True  # others are lit
        left &= blocked[row]
        self._sample(row[left], edges[left], rise[left], sheet[left])

    def _compute_edges(self, row: NDArray, seen_row: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """The corners' weights at d0, d1 and d2, (pairs, corner, d), and their bounds over the square, (pairs, 3)."""
        squares, weights = self._squares, self._seen.weights[seen_row]
        edges = np.stack(
            [np.einsum("ikj,ij->ik", weights, d[row]) for d in (squares.d0, squares.d1, squares.d2)], axis=2
        )
        spread = 0.5 * (np.abs(edges[..., 1]) + np.abs(edges[..., 2]))
        return edges, edges[..., 0] - spread, edges[..., 0] + spread

    def _sample(self, row: NDArray, edges: NDArray, rise: NDArray, sheet: NDArray) -> None:
        """Takes the samples of pixels that are not decided."""
        if not len(row):
            return
        starts = np.flatnonzero(np.diff(row, prepend=-1))
        limit = max(1, SAMPLES_AT_ONCE // self._samples.count)
        begin = 0
        while begin < len(starts):
            end = max(begin + 1, int(np.searchsorted(starts, starts[begin] + limit)))
            stop = starts[end] if end < len(starts) else len(row)
            part = slice(starts[begin], stop)
            pixels = row[starts[begin:end]]
            blocked = self._find_blocked(
                row[part], edges[part], rise[part], sheet[part], starts[begin:end] - starts[begin]
            )
            open_parts = 1.0 - blocked.reshape(len(pixels), LATTICES, -1).mean(axis=2)
            self.visibility[pixels] = open_parts.mean(axis=1)
            self.error[pixels] = open_parts.std(axis=1, ddof=1) / np.sqrt(LATTICES)
            self.sampled_count += len(pixels)
            begin = end

    def _find_blocked(
        self, row: NDArray, edges: NDArray, rise: NDArray, sheet: NDArray, starts: NDArray
    ) -> NDArray[np.bool_]:
        """Which samples of each pixel are in shadow, (pixels, samples)."""
        pixel_of = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(row)))
        a, b = (points[pixel_of] for points in self._samples.make(row[starts]))

        def spread(values: NDArray) -> NDArray:
            return values[:, :1] + a * values[:, 1:2] + b * values[:, 2:]

        hit = spread(rise)
        inside = np.ones(hit.shape, dtype=bool)
        for corner in range(3):
            inside &= spread(edges[:, corner]) >= 0
        if not sheet.any():
            return np.logical_or.reduceat(inside & (hit > 0), starts, axis=0)
        # Heights over the plane, to compare those of the receiver's own surface with the others'.
        total = np.maximum(spread(edges.sum(axis=1)), 1e-300)
        height = np.where(inside, hit / total, -np.inf)
        surface = np.maximum.reduceat(np.where(sheet[:, None], height, 0.0), starts, axis=0)
        blocks = ~sheet[:, None] & (height > np.maximum(surface, 0.0)[pixel_of])
        return np.logical_or.reduceat(blocks, starts, axis=0)
