# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of layers, truth and differences for people to look at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .measures import ACNE, LEAK, WRONG_LIGHT, WRONG_SHADOW
from .pixels import PixelClasses
from .png import encode_png

# Index, colour and legend of the difference picture. Faults stand out from the greys; acne and leaks stand out more.
SHADOW_INDEX, LIT_INDEX, EXCLUDED_INDEX = 0, 1, 2
FAULT_START = 3
DIFFERENCE_COLORS = (
    ((58, 62, 70), "shadow, right"),
    ((216, 219, 224), "light, right"),
    ((132, 142, 158), "not compared"),
    ((226, 62, 70), "false shadow at a border"),
    ((48, 118, 240), "false light at a border"),
    ((255, 0, 170), "acne: false shadow far from any"),
    ((0, 196, 140), "leak: false light far inside a shadow"),
)
FAULTS_IN_ORDER = (WRONG_SHADOW, WRONG_LIGHT, ACNE, LEAK)
PALETTE = tuple(color for color, _ in DIFFERENCE_COLORS)


def quantise(values: NDArray[np.floating], dtype: type = np.uint8) -> NDArray[np.unsignedinteger]:
    """0..1 as integers, rounded; what isn't finite becomes 0."""
    top = np.iinfo(dtype).max
    return np.round(np.clip(np.nan_to_num(values, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0) * top).astype(dtype)


def make_layer_png(visibility: NDArray[np.floating], *, depth: int = 8, text: dict[str, str] | None = None) -> bytes:
    """A layer as it is: (h, w) grey or (h, w, 3) colour, 1 = white, values linear. `depth` 8 or 16 bits."""
    values = visibility[..., 0] if visibility.ndim == 3 and visibility.shape[2] == 1 else visibility
    return encode_png(quantise(values, np.uint16 if depth == 16 else np.uint8), text=text)


def make_truth_png(truth: NDArray[np.bool_], classes: PixelClasses) -> bytes:
    """The truth in black and white; what isn't compared in grey."""
    index = np.where(classes.comparable, np.where(truth, 1, 0), 2).astype(np.uint8)
    return encode_png(index, palette=((0, 0, 0), (255, 255, 255), PALETTE[EXCLUDED_INDEX]))


def make_difference_png(truth: NDArray[np.bool_], classes: PixelClasses, faults: NDArray[np.uint8]) -> bytes:
    """The truth in light greys with the faults in colour."""
    index = np.where(truth, LIT_INDEX, SHADOW_INDEX).astype(np.uint8)
    index[~classes.comparable] = EXCLUDED_INDEX
    for offset, fault in enumerate(FAULTS_IN_ORDER):
        index[faults == fault] = FAULT_START + offset
    return encode_png(index, palette=PALETTE)
