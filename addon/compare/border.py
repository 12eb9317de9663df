# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a layer's border lies from the true one: its mean shift, and the staircase that is left without it.

Along the true border let d be the distance from it to the layer's 1/2-contour, positive where the layer is too light.
The strip between the two has the area sum(|d|) and the first moment sum(d^2) / 2, per length of the border. Both are
sums over the wrong pixels: a pixel whose centre lies r from the border adds 1 to the area and r to the moment. So

    mean(d) = sum(+-1) / length,    mean(d^2) = sum(2 r) / length.

The shift is the mean over the true border; the staircase is the root of the second sum over the border moved by it.

The layer is used at its pixels' centres only, where it is known. It is never traced itself: a contour of one sample per
pixel has a staircase of its own, of 0.29 pixels, that would drown the map's. Sums over centres are free of it, because
the centres lie at all distances from the border alike. r needs the true border finer than a pixel: `contour.py`.
docs/measures.md holds an experiment on edges known in closed form.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .distance import find_nearest_target
from .footprint import compute_singular_values
from .true_border import TrueBorder, dilate, shift_picture

LIT_THRESHOLD = 0.5
BORDER_VALUES = (
    "border_bias_px",
    "border_bias_texels",
    "unbiased_error_px",
    "staircase_px",
    "staircase_texels",
    "unpaired_fraction",
)
# A border has a partner if there is one within this distance, in pixels or in texels across it, whichever is more.
# What is farther is acne or a leak, not a border in the wrong place (see FAR_PX in measures.py).
PARTNER_PX = 2.0
PARTNER_TEXELS = 2.0
# Partners are looked for between pixels' centres; a border lies up to so much nearer.
CENTRE_PX = 1.0
# Farthest that is looked for a partner, however large the texels.
LONGEST_SEARCH_PX = 64.0
# d(pixel)/d(texel) at the pixels (rows, columns): (n,) each; returns (n, 2, 2).
TexelFunction = Callable[[NDArray[np.integer], NDArray[np.integer]], NDArray[np.float64]]


@dataclass(frozen=True)
class BorderMeasures:
    """`values` by measure id (None: undefined, as without a border or a map). `lengths_px`: the true border's length
    that is compared, that has no partner in the layer, and that was left aside (beside another surface, or beside what
    isn't compared). `stray_pixels`: pixels at the layer's border with no true border near; `border_pixels`: all."""

    values: dict[str, float | None]
    lengths_px: dict[str, float]
    stray_pixels: int
    border_pixels: int


def find_layer_border(lit: NDArray[np.bool_], comparable: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Compared pixels with a compared neighbour, beside, above or below, of the other class. (h, w)."""
    border = np.zeros(lit.shape, dtype=bool)
    for step_y, step_x in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        border |= (lit != shift_picture(lit, step_y, step_x)) & shift_picture(comparable, step_y, step_x)
    return border & comparable


def measure_border(
    visibility: NDArray[np.floating],
    truth: NDArray[np.bool_],
    comparable: NDArray[np.bool_],
    border: TrueBorder,
    texels: TexelFunction | None = None,
) -> BorderMeasures:
    """Measures a layer's border. All pictures (h, w), rows in the same order; the truth at the pixels' centres.

    `texels`: how the map's texels lie in the picture; None: no map, so no figures in texels. A value of the layer that
    isn't finite is wrong.
    """
    lit = np.where(np.isfinite(visibility), visibility >= LIT_THRESHOLD, ~truth)
    lit_border = find_layer_border(lit, comparable)
    paired = border.usable.copy()  # elsewhere there may be no surface, and so no texels
    rows, columns = border.rows[paired], border.columns[paired]
    limit_px = _compute_limit(_compute_texel_px(rows, columns, border.normals[paired], texels))
    paired[paired] = _find_partners(rows, columns, lit_border, limit_px)
    length = float(border.lengths_px[paired].sum())
    lengths_px = {
        "compared": length,
        "unpaired": float(border.lengths_px[border.usable & ~paired].sum()),
        "left_aside": float(border.lengths_px[~border.usable].sum()),
    }
    rows, columns = np.nonzero(lit_border)
    # A layer's border has no direction here: the longest side of a texel will do.
    longest_px = np.zeros(len(rows)) if texels is None else compute_singular_values(texels(rows, columns))[0]
    stray = int((~_find_partners(rows, columns, border.pixels, _compute_limit(longest_px))).sum())
    values: dict[str, float | None] = dict.fromkeys(BORDER_VALUES)
    if length > 0:
        values |= _measure_pieces(lit, truth, comparable, border=border, paired=paired, texels=texels)
    whole = length + lengths_px["unpaired"]
    values["unpaired_fraction"] = lengths_px["unpaired"] / whole if whole > 0 else None
    return BorderMeasures(values, lengths_px, stray, int(rows.size))


def _compute_texel_px(
    rows: NDArray[np.integer],
    columns: NDArray[np.integer],
    normals: NDArray[np.float64],
    texels: TexelFunction | None,
) -> NDArray[np.float64]:
    """Pixels that a shift by one texel moves a border with these normals (n, 2) at the pixels (rows, columns); 1
    without a map. A line with the normal n in the picture has M^T n in the map, M = d(pixel)/d(texel)."""
    if texels is None:
        return np.ones(len(rows))
    with np.errstate(invalid="ignore"):  # texels without end, along faces that the light grazes
        return np.linalg.norm(np.einsum("nij,ni->nj", texels(rows, columns), normals), axis=1)


def _compute_limit(texel_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far a partner may be, by the size of a texel; NaN counts as no end."""
    texel_px = np.where(np.isnan(texel_px), np.inf, texel_px)
    return np.minimum(np.maximum(PARTNER_PX, PARTNER_TEXELS * texel_px), LONGEST_SEARCH_PX)


def _find_partners(
    rows: NDArray[np.integer],
    columns: NDArray[np.integer],
    others: NDArray[np.bool_],
    limit_px: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Which of the pixels (rows, columns), (n,), have one of `others` (h, w) within the limit (n,)."""
    width = others.shape[1]
    pixel, back = np.unique(rows * width + columns, return_inverse=True)
    pixel_rows, pixel_columns = np.divmod(pixel, width)
    distance, _, _ = find_nearest_target(others, pixel_rows, pixel_columns, LONGEST_SEARCH_PX)
    return distance[back.reshape(-1)] <= limit_px + CENTRE_PX


@dataclass(frozen=True)
class _Strip:
    """Pixels beside the border: `across_px` (n,) distance of the centre, positive in the true shadow (`in_shadow`; a
    centre may lie on the contour); `texel_px` (n,) pixels across the border that a shift by one texel moves it there,
    1 without a map."""

    in_shadow: NDArray[np.bool_]
    across_px: NDArray[np.float64]
    texel_px: NDArray[np.float64]


def _find_strip(
    chosen: NDArray[np.bool_],
    truth: NDArray[np.bool_],
    border: TrueBorder,
    paired: NDArray[np.bool_],
    texels: TexelFunction | None,
) -> _Strip:
    """Those of the chosen pixels (h, w) whose nearest piece of the border is a paired one, within the limit."""
    rows, columns = np.nonzero(chosen)
    nearest = border.find_nearest(rows, columns, LONGEST_SEARCH_PX)
    kept = nearest.piece >= 0
    kept[kept] = paired[nearest.piece[kept]]
    rows, columns, nearest = rows[kept], columns[kept], nearest.at(kept)
    texel_px = _compute_texel_px(rows, columns, border.normals[nearest.piece], texels)
    near = (nearest.distance_px <= _compute_limit(texel_px)) & np.isfinite(texel_px) & (texel_px > 0)
    in_shadow = ~truth[rows, columns]
    across_px = np.where(in_shadow, 1.0, -1.0) * nearest.distance_px
    return _Strip(in_shadow[near], across_px[near], texel_px[near])


def _measure_pieces(
    lit: NDArray[np.bool_],
    truth: NDArray[np.bool_],
    comparable: NDArray[np.bool_],
    *,
    border: TrueBorder,
    paired: NDArray[np.bool_],
    texels: TexelFunction | None,
) -> dict[str, float | None]:
    """The values of VALUES, by the sums in the text at the top of this file.

    The layer's shift is a number of texels where it has a map (a map is off by texels, whatever they measure in the
    picture) and of pixels where not.
    """
    length = border.lengths_px[paired].sum()
    wrong = _find_strip(comparable & (lit != truth), truth, border, paired, texels)
    sign = np.where(wrong.in_shadow, 1.0, -1.0)  # wrong in the shadow: too light
    shift = float((sign / wrong.texel_px).sum() / length)  # in texels, or pixels without a map

    # Against the border moved by the shift, the pixels that it passed over change sides.
    held = np.zeros(lit.shape, dtype=bool)
    held[border.rows[paired], border.columns[paired]] = True
    radius_px = min(abs(shift) * wrong.texel_px.max(initial=0.0), LONGEST_SEARCH_PX)
    passed = comparable & (lit == truth) & (truth if shift < 0 else ~truth) & dilate(held, int(np.ceil(radius_px)) + 1)
    right = _find_strip(passed, truth, border, paired, texels)
    area = square_px = square_texels = 0.0
    for strip, is_right in ((wrong, False), (right, True)):
        rest_px = strip.across_px - shift * strip.texel_px
        # Wrong now: those whose class the move has changed, and that were right; or the other way round.
        moved = np.where(strip.in_shadow, rest_px < 0, rest_px > 0)
        counted = moved == is_right
        area += float(counted.sum())
        square_px += float((2.0 * np.abs(rest_px))[counted].sum())
        square_texels += float((2.0 * np.abs(rest_px) / strip.texel_px**2)[counted].sum())
    return {
        "border_bias_px": float(sign.sum() / length),
        "border_bias_texels": None if texels is None else shift,
        "unbiased_error_px": area / length,
        "staircase_px": math.sqrt(square_px / length),
        "staircase_texels": None if texels is None else math.sqrt(square_texels / length),
    }
