# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of truths between 0 and 1, and of a layer's error against them, for people to look at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .pictures import EXCLUDED_INDEX, PALETTE, quantise
from .pixels import PixelClasses
from .png import encode_png

# The error that is shown in full colour; larger ones too.
FULL_ERROR = 0.25
NO_ERROR_COLOR, TOO_DARK_COLOR, TOO_LIGHT_COLOR = (236, 238, 241), (200, 24, 60), (24, 84, 214)
ERROR_COLORS = (
    (NO_ERROR_COLOR, "right"),
    (PALETTE[EXCLUDED_INDEX], "not compared"),
    (TOO_DARK_COLOR, f"too dark by {FULL_ERROR} or more"),
    (TOO_LIGHT_COLOR, f"too light by {FULL_ERROR} or more"),
)


def make_value_png(truth: NDArray[np.floating], classes: PixelClasses) -> bytes:
    """The truth (h, w), 0 to 1, in greys; what isn't compared in the colour of that."""
    picture = np.repeat(quantise(truth)[..., None], 3, axis=2)
    picture[~classes.comparable] = PALETTE[EXCLUDED_INDEX]
    return encode_png(picture)


def make_error_png(visibility: NDArray[np.floating], truth: NDArray[np.floating], classes: PixelClasses) -> bytes:
    """Layer minus truth, (h, w): red where the layer is too dark, blue where it is too light."""
    # What isn't finite is wrong all over, as in the measures.
    error = np.where(np.isfinite(visibility), visibility - truth, np.where(truth >= 0.5, -1.0, 1.0))
    part = np.clip(np.abs(error) / FULL_ERROR, 0.0, 1.0)[..., None]
    color = np.where((error < 0)[..., None], TOO_DARK_COLOR, TOO_LIGHT_COLOR)
    picture = np.round((1.0 - part) * NO_ERROR_COLOR + part * color).astype(np.uint8)
    picture[~classes.comparable] = PALETTE[EXCLUDED_INDEX]
    return encode_png(picture)
