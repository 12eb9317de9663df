# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What comes out of the truth's renders, and how it is computed from their pictures."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

# A ratio this near to 0 or 1 is that value; others are counted as undecided and compared as what they are nearer to.
RATIO_TOLERANCE = 1e-3


class TruthError(RuntimeError):
    """Cycles gave no truth; the text names the culprit and the remedy."""


@dataclass(frozen=True)
class TruthSurface:
    """What Cycles sees through the pixels' centres, row 0 at the bottom."""

    positions_ws: NDArray[np.float32]  # (h, w, 3)
    covered: NDArray[np.bool_]  # (h, w)
    time_ms: float


@dataclass(frozen=True)
class LightTruth:
    """The hard shadow of one light, row 0 at the bottom."""

    visible: NDArray[np.bool_]  # (h, w) the light reaches the point
    lit: NDArray[np.bool_]  # (h, w) it would, if nothing cast shadows: faces it, is in its cone, linked to it
    undecided_count: int  # pixels whose ratio is neither 0 nor 1
    times_ms: dict[str, float]  # "shadows_on", "shadows_off"


@dataclass(frozen=True)
class SampledTruth:
    """A truth of many samples, row 0 at the bottom. Soft: of the light in its real size, the part that arrives of what
    arrives without shadows. Pixel: the hard mask's mean over the pixel's square."""

    visibility: NDArray[np.float32]  # (h, w) 0 to 1
    error: NDArray[np.float32]  # (h, w) its standard error
    lit: NDArray[np.bool_]  # (h, w) some light would arrive, if nothing cast shadows
    samples: int  # per pixel
    times_ms: dict[str, float]  # "shadows_on", "shadows_off": of all renders


def load_pixels(path: str, width: int, height: int) -> NDArray[np.float32]:
    """The four channels of a picture file as they are: (h, w, 4), row 0 at the bottom. Raises TruthError."""
    image = bpy.data.images.load(path, check_existing=False)
    try:
        image.colorspace_settings.name = "Non-Color"
        if tuple(image.size) != (width, height):
            raise TruthError(f"Cycles wrote {tuple(image.size)} pixels instead of {(width, height)} to {path}")
        pixels = np.empty(width * height * 4, dtype=np.float32)
        image.pixels.foreach_get(pixels)
    finally:
        bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)


def compute_light_truth(
    shadowed: NDArray[np.float32], open_sky: NDArray[np.float32], times_ms: dict[str, float]
) -> LightTruth:
    """Truth from the renders with and without shadows, (h, w) each."""
    lit = open_sky > 0.0
    ratio = np.divide(shadowed, open_sky, out=np.zeros_like(shadowed), where=lit)
    decided = (ratio < RATIO_TOLERANCE) | (np.abs(ratio - 1.0) < RATIO_TOLERANCE)
    return LightTruth(ratio >= 0.5, lit, int((lit & ~decided).sum()), times_ms)


def compute_soft_truth(pairs: NDArray[np.float32], samples: int, times_ms: dict[str, float]) -> SampledTruth:
    """Truth from several pairs of renders with and without shadows, (renders, 2, h, w), of independent samples."""
    shadowed, open_sky = (pairs[:, part].astype(np.float64) for part in range(2))
    # Both renders of a pair take the same places of the light, so they leave little noise in their ratio.
    ratios = np.clip(np.divide(shadowed, open_sky, out=np.zeros_like(shadowed), where=open_sky > 0.0), 0.0, 1.0)
    total = open_sky.sum(axis=0)
    mean = np.clip(np.divide(shadowed.sum(axis=0), total, out=np.zeros_like(total), where=total > 0.0), 0.0, 1.0)
    error = ratios.std(axis=0, ddof=1) / np.sqrt(len(ratios))
    return SampledTruth(mean.astype(np.float32), error.astype(np.float32), total > 0.0, samples, times_ms)


def average_blocks(picture: NDArray, across: int) -> NDArray[np.float64]:
    """Means over squares of `across` x `across` samples: (h * across, w * across) to (h, w)."""
    height, width = picture.shape[0] // across, picture.shape[1] // across
    return picture.reshape(height, across, width, across).mean(axis=(1, 3), dtype=np.float64)


def compute_sample_visibility(
    shadowed: NDArray[np.float32], open_sky: NDArray[np.float32], unreached: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """The hard mask of single samples, (h, w) each: of those that the light shines on if nothing casts shadows, which
    it reaches; of the others those `unreached`, which are none of its receivers. The rest is turned away."""
    lit = open_sky > 0.0
    return np.where(lit, shadowed >= 0.5 * open_sky, unreached)


def compute_pixel_truth(
    means: NDArray[np.float64], lit: NDArray[np.bool_], samples: int, times_ms: dict[str, float]
) -> SampledTruth:
    """Truth from the pixels' means over independent groups of samples, (groups, h, w)."""
    error = means.std(axis=0, ddof=1) / np.sqrt(len(means))
    return SampledTruth(means.mean(axis=0).astype(np.float32), error.astype(np.float32), lit, samples, times_ms)
