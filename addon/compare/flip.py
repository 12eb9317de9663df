# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""FLIP beside the measures, where its package is installed: an estimate of what a viewer would notice.

[Andersson20] Andersson et al., FLIP: A Difference Evaluator for Alternating Images, 2020. Package `flip-evaluator`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MISSING_NOTE = "FLIP is left out: the Python package flip-evaluator is not installed in this Blender's Python."


def is_flip_available() -> bool:
    try:
        import flip_evaluator  # noqa: F401
    except ImportError:
        return False
    return True


def compute_mean_flip(
    visibility: NDArray[np.floating], truth: NDArray[np.bool_], comparable: NDArray[np.bool_]
) -> float | None:
    """Mean FLIP (0..1, low dynamic range, the package's viewing distance) of the layer against the truth, both shown
    as grey pictures in which pixels that aren't compared are equal. (h, w) each. None without the package."""
    try:
        import flip_evaluator
    except ImportError:
        return None
    pictures = []
    for picture in (truth.astype(np.float32), np.nan_to_num(visibility, nan=0.0, posinf=1.0, neginf=0.0)):
        grey = np.where(comparable, np.clip(picture, 0.0, 1.0), 0.5).astype(np.float32)[::-1]
        pictures.append(np.ascontiguousarray(np.repeat(grey[..., None], 3, axis=2)))
    _, mean, _ = flip_evaluator.evaluate(pictures[0], pictures[1], "LDR", inputsRGB=True, applyMagma=False)
    return float(mean)
