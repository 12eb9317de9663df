# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The filtered truth: the exact mask of a light without size, averaged over a square round each receiver.

The square lies in the map's plane (its side in texels) or in the receiver's (in scene units). Each of its points stands
for the point of the receiver's plane that the light sees there; that one is in shadow if a triangle lies before it.
The receiver's own surface is no blocker: where it rises before the plane, it takes its place. Points where it has ended
and its plane lies buried under a surface that the plane runs into are as lit as the receiver's surface in the square is
on average (receiver_sheet.py). All in double, from the triangles; no map, no bias.

A pixel is decided as a whole where no triangle that touches its square comes before its plane, or one covers it; both
are exact. Elsewhere a fixed number of points is taken, in four lattices shifted anew for each pixel, whose spread gives
the standard error.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .footprint import choose_views
from .light_bins import LightBins, SeenTriangles, View, see_triangles
from .light_squares import Footprint, LightSquares, Receivers, group_by_size, make_squares
from .receiver_sheet import Surfaces, find_surfaces
from .sample_points import LATTICES, PixelSamples
from .scene_triangles import SceneTriangles

# Pairs of pixel and triangle at once, and samples of pairs: what fits a processor's caches.
PAIRS_AT_ONCE = 1 << 17
SAMPLES_AT_ONCE = 1 << 18


@dataclass(frozen=True)
class FilteredVisibility:
    """For each receiver, 0 to 1, and the standard error of what was sampled."""

    visibility: NDArray[np.float32]  # (n,)
    error: NDArray[np.float32]  # (n,)
    sampled_count: int  # receivers that were not decided as a whole


def compute_filtered_visibility(
    triangles: SceneTriangles,
    casters: NDArray[np.int64],
    *,
    views: Sequence[View],
    receivers: Receivers,
    footprint: Footprint,
    sample_count: int,
    threads: int = 0,
) -> FilteredVisibility:
    """The truth of receivers that face the light. `casters`: the triangles that cast. `views`: of the light's maps, as
    a layer tells them; a receiver belongs to the one in whose pyramid it lies. `sample_count` is rounded up to a
    multiple of four. `threads` (0: one for each processor) doesn't change the result."""
    count = len(receivers.points_ws)
    visibility, error = np.ones(count, np.float32), np.zeros(count, np.float32)
    sampled = 0
    is_caster = np.zeros(len(triangles.instance), dtype=bool)
    is_caster[casters] = True
    # The receivers' own surfaces count too, whether they cast or not.
    shown = np.zeros(len(triangles.first), dtype=bool)
    shown[triangles.instance[receivers.triangle]] = True
    wanted = np.flatnonzero(is_caster | shown[triangles.instance])
    chosen = choose_views([view.transform(receivers.points_ws) for view in views])
    for number, view in enumerate(views):
        rows = np.flatnonzero(chosen == number)
        if not len(rows) or not len(casters):
            continue
        squares = make_squares(view, triangles, receivers, rows, footprint)
        depth = view.get_depth(view.make_rays(squares.points_ls))
        seen = see_triangles(view, triangles.corners_ws, wanted, float(np.abs(depth).max()))
        for group in group_by_size(squares):
            caster = _Caster(triangles, seen, squares.take(group), receivers.pixel[rows[group]], sample_count)
            caster.casts = is_caster[seen.index]
            caster.cast(threads)
            visibility[rows[group]], error[rows[group]] = caster.visibility, caster.error
            sampled += caster.sampled_count
    return FilteredVisibility(visibility, error, sampled)


class _Caster:
    """Squares of one view and of about one size."""

    def __init__(
        self, triangles: SceneTriangles, seen: SeenTriangles, squares: LightSquares, pixel: NDArray, sample_count: int
    ) -> None:
        self._triangles, self._seen, self._squares = triangles, seen, squares
        self._samples = PixelSamples(pixel, sample_count)
        count = len(pixel)
        self.visibility, self.error = np.ones(count, np.float32), np.zeros(count, np.float32)
        self.casts = np.ones(len(seen.index), dtype=bool)
        self.sampled_count = 0
        low, high = squares.place.min(axis=0), squares.place.max(axis=0)
        reach = squares.half.max(axis=0)
        if np.isinf(reach).any():
            low, high, reach = np.full(2, -np.inf), np.full(2, np.inf), np.zeros(2)
        self._bins = LightBins(seen, low, high, reach) if np.isfinite(low).all() else None

    def cast(self, threads: int) -> None:
        """Fills visibility, error and sampled_count."""
        squares, seen = self._squares, self._seen
        if self._bins is None:
            entries, lows, highs = np.arange(len(seen.index)), seen.low, seen.high
            first, count = np.zeros(len(squares.place), np.int64), np.full(len(squares.place), len(entries))
        else:
            entries, lows, highs = self._bins.entries, self._bins.low, self._bins.high
            first, count = self._bins.find(squares.place)
        square_lows, square_highs = squares.place - squares.half, squares.place + squares.half
        order = np.argsort(first, kind="stable")
        order = order[count[order] > 0]

        def cast_part(part: slice) -> int:
            rows = order[part]
            counts = count[rows]
            row = np.repeat(rows, counts)
            start = np.repeat(first[rows] - (np.cumsum(counts) - counts), counts)
            at = start + np.arange(len(row))
            touches = (highs[at] >= square_lows[row]) & (lows[at] <= square_highs[row])
            touches = touches[:, 0] & touches[:, 1]
            return self._cast_pairs(row[touches], entries[at[touches]])

        # Parts write to pixels of their own, and NumPy lets go of the interpreter's lock in all that takes time.
        with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
            self.sampled_count = sum(pool.map(cast_part, cut(count[order], PAIRS_AT_ONCE)))

    def _cast_pairs(self, row: NDArray[np.int64], seen_row: NDArray[np.int64]) -> int:
        """Pairs of pixel and triangle; all of a pixel's triangles are there, and follow one another. Returns how many
        pixels were sampled."""
        squares, seen = self._squares, self._seen
        edges, low, high = self._compute_edges(row, seen_row)
        touches = (high >= 0).all(axis=1)
        row, seen_row, edges, low = row[touches], seen_row[touches], edges[touches], low[touches]
        # Signed distances of the corners from the receiver's plane, less what rounding can make of a flat surface.
        heights = np.einsum("ikj,ij->ik", seen.corners_ls[seen_row], squares.normals_ls[row])
        heights -= np.einsum("ij,ij->i", squares.points_ls[row], squares.normals_ls[row])[:, None]
        heights -= (self._triangles.rounding[seen.index[seen_row]] + squares.rounding[row])[:, None]
        rise = np.einsum("ikd,ik->id", edges, heights)
        spread = 0.5 * (np.abs(rise[:, 1]) + np.abs(rise[:, 2]))
        before = self.casts[seen_row] & (heights.max(axis=1) > 0) & (rise[:, 0] + spread > 0)
        meets = before & (heights.min(axis=1) <= 0) & (rise[:, 0] - spread < 0)
        surfaces = find_surfaces(
            self._triangles, seen, row, seen_row, receiver=squares.triangle[row], before=before, meets=meets
        )
        blocks = before & ~surfaces.own
        covers = blocks & (low >= 0).all(axis=1) & (rise[:, 0] - spread > 0)
        # With a surface before the plane, a triangle that covers the square may still lie behind that surface.
        raised = self._mark(row[(surfaces.own & before) | surfaces.met])
        dark = self._mark(row[covers]) & ~raised
        self.visibility[dark] = 0.0
        # The others without a blocker are lit. The receiver's own triangles are needed to tell where it ends.
        left = (self._mark(row[blocks]) & ~dark)[row] & (before | surfaces.own)
        part = Surfaces(surfaces.own[left], surfaces.met[left])
        return self._sample(row[left], edges[left], rise[left], part)

    def _mark(self, rows: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Which of the squares are among `rows`."""
        marked = np.zeros(len(self._squares.place), dtype=bool)
        marked[rows] = True
        return marked

    def _compute_edges(self, row: NDArray, seen_row: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """The corners' weights at d0, d1 and d2, (pairs, corner, d), and their bounds over the square, (pairs, 3)."""
        squares, weights = self._squares, self._seen.weights[seen_row]
        edges = np.stack(
            [np.einsum("ikj,ij->ik", weights, d[row]) for d in (squares.d0, squares.d1, squares.d2)], axis=2
        )
        spread = 0.5 * (np.abs(edges[..., 1]) + np.abs(edges[..., 2]))
        return edges, edges[..., 0] - spread, edges[..., 0] + spread

    def _sample(self, row: NDArray, edges: NDArray, rise: NDArray, surfaces: Surfaces) -> int:
        """Takes the samples of pixels that are not decided, and returns how many pixels these are."""
        if not len(row):
            return 0
        # Float32 from here on: the weights at the square's middle are exact enough, and the samples are differences
        # from it. Powers of two keep the two sides of an edge exact opposites.
        _, exponent = np.frexp(np.abs(edges).max(axis=(1, 2)))
        edges = np.ldexp(edges, -exponent[:, None, None]).astype(np.float32)
        rise = np.ldexp(rise, -exponent[:, None]).astype(np.float32)
        firsts = np.flatnonzero(np.diff(row, prepend=-1))
        counts = np.diff(firsts, append=len(row))
        for pixels in cut(counts, max(1, SAMPLES_AT_ONCE // self._samples.count)):
            starts = firsts[pixels]
            part = slice(starts[0], starts[-1] + counts[pixels][-1])
            values = self._shade(
                row[part], edges[part], rise[part],
                surfaces=Surfaces(surfaces.own[part], surfaces.met[part]), starts=starts - starts[0],
            )  # fmt: skip
            means = values.reshape(len(starts), LATTICES, -1).mean(axis=2)
            self.visibility[row[starts]] = means.mean(axis=1)
            self.error[row[starts]] = means.std(axis=1, ddof=1) / np.sqrt(LATTICES)
        return len(firsts)

    def _shade(
        self, row: NDArray, edges: NDArray, rise: NDArray, *, surfaces: Surfaces, starts: NDArray
    ) -> NDArray[np.float64]:
        """How lit each sample of each pixel is, (pixels, samples)."""
        pixel_of = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(row)))
        # After the samples the receiver's point itself, which is asked where its surface falls between them.
        points = (np.pad(points.astype(np.float32), ((0, 0), (0, 1))) for points in self._samples.make(row[starts]))
        a, b = (values[pixel_of] for values in points)

        def spread(values: NDArray) -> NDArray:
            return values[:, :1] + a * values[:, 1:2] + b * values[:, 2:]

        hit = spread(rise)
        inside = np.ones(hit.shape, dtype=bool)
        for corner in range(3):
            inside &= spread(edges[:, corner]) >= 0
        own, met = surfaces.own[:, None], surfaces.met[:, None]
        if not own.any() and not met.any():
            return 1.0 - np.logical_or.reduceat(inside & (hit > 0), starts, axis=0)[:, :-1]
        # Heights over the plane, to compare those of the surfaces with the others'.
        total = np.maximum(spread(edges.sum(axis=1)), np.float32(1e-30))
        height = np.where(inside, hit / total, np.float32(-np.inf))
        level = np.maximum.reduceat(np.where(own, height, np.float32(0.0)), starts, axis=0)
        blocks = ~own & (height > np.maximum(level, 0)[pixel_of])
        blocked = np.logical_or.reduceat(blocks, starts, axis=0)
        shown = np.logical_or.reduceat(inside & own, starts, axis=0)
        buried = ~shown & np.logical_or.reduceat(met & (height > 0.0), starts, axis=0)
        return fill_buried(~blocked, shown, buried)[:, :-1]


def cut(counts: NDArray[np.integer], limit: int) -> list[slice]:
    """Cuts a list of things, each of which counts so much, into parts of not more than the limit, or of one thing."""
    ends = np.cumsum(counts)
    parts, begin = [], 0
    while begin < len(ends):
        done = ends[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, done + limit, side="right")))
        parts.append(slice(begin, end))
        begin = end
    return parts


def fill_buried(lit: NDArray[np.bool_], shown: NDArray[np.bool_], buried: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Gives the samples `buried` the mean of those where the receiver's own surface is, `shown`; of its point, the
    last of them, where no sample meets it. (pixels, samples + 1) each."""
    shown = shown.copy()
    shown[:, -1] = ~shown[:, :-1].any(axis=1)
    mean = (lit & shown).sum(axis=1, keepdims=True) / shown.sum(axis=1, keepdims=True)
    return np.where(buried, mean, lit)
