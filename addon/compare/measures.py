# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a shadow layer is from the truth. Each measure is defined here once; docs/measures.md explains.

All measures run over the comparable pixels: both renderers see the same face there and it is turned to the light.
With s the layer (0..1, 1 = lit), t the truth (0..1, hard ones 0 or 1) and "wrong" meaning (s >= 0.5) != (t >= 0.5):
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .border import BORDER_VALUES, LONGEST_SEARCH_PX, BorderMeasures, TexelFunction, measure_border
from .distance import compute_nearest_distance, find_nearest_target
from .true_border import TrueBorder

LIT_THRESHOLD = 0.5
# "Far" from the true border: more than this many pixels and more than this many of the map's texels.
FAR_PX = 2.0
FAR_TEXELS = 2.0
FAINTEST_LIGHT = 0.5 / 255.0


@dataclass(frozen=True)
class MeasureInfo:
    """A measure's id (its name in JSON), label, unit and meaning."""

    id: str
    label: str
    unit: str  # "fraction" of the comparable pixels (of the border: "length"), "visibility" (0..1), "px", "texels"
    help: str
    is_detail: bool = False  # shown beside the pictures, not in the summary


MEASURES = (
    MeasureInfo("misclassified_fraction", "Misclassified", "fraction", "wrong pixels: lit instead of shadowed or back"),
    MeasureInfo("signed_bias", "Bias", "visibility", "mean of s - t; positive: the layer is too light"),
    MeasureInfo("mae", "MAE", "visibility", "mean of |s - t|"),
    MeasureInfo("rmse", "RMSE", "visibility", "root of the mean of (s - t) squared"),
    MeasureInfo("border_mae", "Border MAE", "visibility", "mean of |s - t| where t is neither 0 nor 1"),
    MeasureInfo(
        "p99_border_distance_px",
        "P99 distance",
        "px",
        "99 % of the wrong pixels' centres lie within this distance of the true shadow's border",
    ),
    MeasureInfo("acne_fraction", "Acne", "fraction", "shadow more than 2 px and 2 texels from any true shadow"),
    MeasureInfo("leak_fraction", "Leak", "fraction", "light more than 2 px and 2 texels inside a true shadow"),
    MeasureInfo(
        "leak_weight",
        "Leak weight",
        "fraction",
        "light, by its strength, 2 px and 2 texels inside full shadow",
    ),
    MeasureInfo(
        "border_bias_px",
        "Shift (px)",
        "px",
        "mean distance of the layer's border from the true one; positive: light",
        True,
    ),
    MeasureInfo(
        "border_bias_texels", "Shift", "texels", "how many texels of the map the border is off; positive: light"
    ),
    MeasureInfo(
        "unbiased_error_px", "Unbiased", "px", "wrong area per length of border, once it is moved by the shift"
    ),
    MeasureInfo("staircase_px", "Staircase", "px", "RMS distance of the border from the true one moved by the shift"),
    MeasureInfo("staircase_texels", "Staircase (texels)", "texels", "the same in texels of the map, across the border"),
    MeasureInfo(
        "unpaired_fraction", "Unpaired", "length", "share of the true border with none of the layer's near", True
    ),
)

WRONG_SHADOW, WRONG_LIGHT, ACNE, LEAK = 1, 2, 3, 4

# Pixels one texel covers at the pixels (rows, columns): (n,) each; returns (n,).
FootprintFunction = Callable[[NDArray[np.integer], NDArray[np.integer]], NDArray[np.floating]]


@dataclass(frozen=True)
class LayerMeasures:
    """`values` by measure id (float; None: undefined), `pixel_count` comparable pixels, `faults` (h, w) uint8: 0 right,
    WRONG_SHADOW, WRONG_LIGHT, ACNE or LEAK. `border`: lengths and counts behind the border's values, if it was given.
    """

    values: dict[str, float | None]
    pixel_count: int
    faults: NDArray[np.uint8]
    border: BorderMeasures | None = None


def compute_border_distance_px(
    wrong: NDArray[np.bool_], opposite: NDArray[np.bool_]
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """Rows, columns and border distance of the wrong pixels. The border runs half a pixel before the nearest pixel of
    the opposite true class, so a pixel right at the border is 0.5 away; infinity: the picture has no such pixel."""
    rows, columns = np.nonzero(wrong)
    return rows, columns, compute_nearest_distance(opposite, rows, columns) - 0.5


def measure_layer(
    visibility: NDArray[np.floating],
    truth: NDArray[np.bool_] | NDArray[np.floating],
    comparable: NDArray[np.bool_],
    *,
    facing_away: NDArray[np.bool_] | None = None,
    footprint_px: FootprintFunction | None = None,
    border: TrueBorder | None = None,
    texels: TexelFunction | None = None,
) -> LayerMeasures:
    """Measures a layer. All arrays (h, w), rows in the same order.

    `visibility` 0..1; a value that isn't finite counts as wrong and as an error of 1. `truth` True = lit, or 0..1.
    `facing_away`: pixels that are dark because they are turned away from the light; a false shadow that hangs on to
    them is no acne. `footprint_px`: pixels covered by a texel, for the measures in texels; None: no map, two pixels.
    `border`: the true border, for shift and staircase; None: these are undefined. `texels`: how the texels lie in the
    picture, for these; None: no map.
    """
    if not (visibility.shape == truth.shape == comparable.shape):
        raise ValueError(
            f"layer {visibility.shape}, truth {truth.shape} and mask {comparable.shape} differ in size: "
            "render all three with the same resolution"
        )
    faults = np.zeros(truth.shape, dtype=np.uint8)
    pixel_count = int(comparable.sum())
    if pixel_count == 0:
        return LayerMeasures({measure.id: None for measure in MEASURES}, 0, faults)

    truth_lit = truth if truth.dtype == bool else truth >= LIT_THRESHOLD
    finite = np.isfinite(visibility)
    safe = np.where(finite, visibility, np.where(truth_lit, 0.0, 1.0)).astype(np.float64)
    error = np.where(finite, safe - truth, np.where(truth_lit, -1.0, 1.0))[comparable]
    lit = safe >= LIT_THRESHOLD
    true_lit, true_shadow = comparable & truth_lit, comparable & ~truth_lit
    dark = true_shadow if facing_away is None else true_shadow | facing_away
    distances = [
        mark_faults(faults, (WRONG_SHADOW, ACNE), true_lit & ~lit, dark, footprint_px),
        mark_faults(faults, (WRONG_LIGHT, LEAK), true_shadow & lit, true_lit, footprint_px),
    ]
    counts = np.bincount(faults.ravel(), minlength=LEAK + 1)
    wrong_count = int(counts[1:].sum())
    values: dict[str, float | None] = {
        "misclassified_fraction": wrong_count / pixel_count,
        "signed_bias": float(error.mean()),
        "mae": float(np.abs(error).mean()),
        "rmse": float(np.sqrt(np.square(error).mean())),
        "border_mae": compute_border_mae(error, truth[comparable]),
        "p99_border_distance_px": compute_p99(np.concatenate(distances)),
        "acne_fraction": int(counts[ACNE]) / pixel_count,
        "leak_fraction": int(counts[LEAK]) / pixel_count,
        "leak_weight": compute_leak_weight(safe, truth, comparable, footprint_px) / pixel_count,
        **dict.fromkeys(BORDER_VALUES),
    }
    if border is None:
        return LayerMeasures(values, pixel_count, faults)
    side = truth_lit if border.lit is None else border.lit
    found = measure_border(visibility, side, comparable, border, texels)
    return LayerMeasures({**values, **found.values}, pixel_count, faults, found)


def count_border_pixels(truth_lit: NDArray[np.bool_], comparable: NDArray[np.bool_]) -> int:
    """Comparable pixels (h, w) that have one on the other side of the true border among their four neighbours."""
    at_border = np.zeros(truth_lit.shape, dtype=bool)
    for axis in (0, 1):
        lit, compared, found = (np.moveaxis(picture, axis, 0) for picture in (truth_lit, comparable, at_border))
        crossed = (lit[1:] != lit[:-1]) & compared[1:] & compared[:-1]
        found[1:] |= crossed
        found[:-1] |= crossed
    return int(at_border.sum())


def mark_faults(
    faults: NDArray[np.uint8],
    kinds: tuple[int, int],
    wrong: NDArray[np.bool_],
    opposite: NDArray[np.bool_],
    footprint_px: FootprintFunction | None,
) -> NDArray[np.float64]:
    """Writes the wrong pixels into `faults`, as the first kind near the border and as the second far from it; returns
    their border distances in pixels."""
    rows, columns, distance = compute_border_distance_px(wrong, opposite)
    texel_px = np.zeros(distance.shape) if footprint_px is None else footprint_px(rows, columns)
    # An infinite distance is far whatever the texel; an infinite texel (light along the face) never lets it be.
    far = np.isinf(distance) | (distance > np.maximum(FAR_PX, FAR_TEXELS * texel_px))
    faults[rows, columns] = np.where(far, kinds[1], kinds[0])
    return distance


def compute_border_mae(error: NDArray[np.floating], truth: NDArray[np.bool_] | NDArray[np.floating]) -> float | None:
    """Mean size of the errors where the truth is neither full light nor full shadow, (n,) each; None: nowhere."""
    between = (truth > 0) & (truth < 1)
    return float(np.abs(error[between]).mean()) if between.any() else None


def compute_leak_weight(
    visibility: NDArray[np.floating],
    truth: NDArray[np.bool_] | NDArray[np.floating],
    comparable: NDArray[np.bool_],
    footprint_px: FootprintFunction | None,
) -> float:
    """Sum of the layer's light over the pixels deep in full shadow: far from any with a truth above 0. Light fainter
    than a picture of 8 bits shows is left out."""
    rows, columns = np.nonzero(comparable & (truth == 0) & (visibility > FAINTEST_LIGHT))
    texel_px = np.zeros(len(rows)) if footprint_px is None else footprint_px(rows, columns)
    limit = np.minimum(np.maximum(FAR_PX, FAR_TEXELS * texel_px), LONGEST_SEARCH_PX)
    farthest = float(limit.max(initial=FAR_PX)) + 0.5
    distance = find_nearest_target(comparable & (truth > 0), rows, columns, farthest)[0] - 0.5
    return float(np.clip(visibility[rows, columns], 0.0, 1.0)[distance > limit].sum())


def compute_p99(distances: NDArray[np.float64]) -> float | None:
    """Smallest distance that 99 % of the given ones don't exceed; 0 for none; None where that one is infinite."""
    if distances.size == 0:
        return 0.0
    value = float(np.sort(distances)[int(np.ceil(0.99 * distances.size)) - 1])
    return value if np.isfinite(value) else None
