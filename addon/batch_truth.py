# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which truth the batch's verb compare measures each layer against (docs/measures.md)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import bridge
from .capture import CapturedFrame, CapturedLayer
from .compare.light_squares import Footprint
from .compare.pixels import PixelClasses
from .truth import LightTruth
from .truth_store import TruthStore

HARD, FILTERED, SOFT, PIXEL, NAMED = "hard", "filtered", "soft", "pixel", "named"
# Rendered by Cycles for themselves, with many samples; layers of a light share each.
SAMPLED = (SOFT, PIXEL)
# A layer that names no square is compared with the filtered truth of one texel, if that is asked for; one without a map
# with that of its pixels' points.
PLAIN_FOOTPRINT = Footprint(texels=1.0)


@dataclass(frozen=True)
class LayerTruth:
    """A truth that layers are measured against."""

    kind: str
    values: NDArray[np.bool_] | NDArray[np.float32]  # (h, w) hard: True = lit; else 0 to 1
    error: NDArray[np.float32] | None  # (h, w) standard error; None: exact
    samples: int  # per pixel
    footprint: Footprint
    times_ms: dict[str, float]
    cached: bool

    def describe(self, comparable: NDArray[np.bool_]) -> dict[str, Any]:
        """What a record says of its truth. `rms` is the least RMSE that the truth's own noise leaves to any layer,
        `bias` the standard error of the mean of the truth, and so of a layer's bias."""
        count = int(comparable.sum())
        squares = 0.0 if self.error is None else float(np.square(self.error[comparable], dtype=np.float64).sum())
        return {
            "kind": self.kind,
            "samples": self.samples,
            "footprint_texels": self.footprint.texels,
            "footprint_world": self.footprint.world,
            "standard_error": {
                "rms": math.sqrt(squares / count) if count else None,
                "bias": math.sqrt(squares) / count if count else None,
            },
            "time_ms": {stage: round(value, 4) for stage, value in self.times_ms.items()},
            "cached": self.cached,
        }

    def get_label(self) -> str:
        """For the page: which truth it is."""
        if self.kind == HARD:
            return "hard: Cycles, the light without size"
        if self.kind == SOFT:
            return f"soft: Cycles, the light in its size, {self.samples} samples"
        if self.kind == PIXEL:
            return f"pixel: Cycles, the light without size, {self.samples} places in the pixel"
        if not self.footprint.texels and not self.footprint.world:
            return "filtered: the exact mask, at the pixels' points"
        side = f"{self.footprint.texels:g} texels" if self.footprint.texels else f"{self.footprint.world:g} scene units"
        return f"filtered: the exact mask over a square of {side}, {self.samples} samples"


def choose_kinds(asked: Sequence[str], layer: CapturedLayer) -> list[str]:
    """The kinds of truth for a layer, each once."""
    named = bridge.get_truth(layer.technique, layer.parameters)["kind"]
    return list(dict.fromkeys(named if kind == NAMED else kind for kind in asked))


class LightTruths:
    """The truths of one light in one frame; each is made when it is first asked for. `hard` and the pixels' classes
    are there already."""

    def __init__(
        self, store: TruthStore, captured: CapturedFrame, hard: tuple[LightTruth, bool], classes: PixelClasses,
        *, sample_count: int,
    ) -> None:  # fmt: skip
        self._store, self._captured, self._classes = store, captured, classes
        self._hard, self._hard_cached = hard
        self._sample_count = sample_count
        self._made: dict[Any, LayerTruth] = {}

    def get(self, layer: CapturedLayer, kind: str) -> LayerTruth:
        """The truth of that kind for a layer of this light; the same object for layers that share it. TruthError."""
        if kind == FILTERED:
            spec = bridge.get_truth(layer.technique, layer.parameters)
            world = spec["footprint_world"]
            footprint = Footprint(0.0 if world else spec["footprint_texels"], world)
            if not footprint.texels and not footprint.world and spec["kind"] != FILTERED:
                footprint = PLAIN_FOOTPRINT if layer.views else Footprint()
            views = tuple((*view["texel_size"], view["view_from_world"].tobytes()) for view in layer.views)
            key: Any = (kind, footprint, views)
        else:
            footprint, key = Footprint(), kind
        if key not in self._made:
            self._made[key] = self._make(layer, kind, footprint)
        return self._made[key]

    def _make(self, layer: CapturedLayer, kind: str, footprint: Footprint) -> LayerTruth:
        light = self._captured.snapshot.lights[layer.job.light]
        if kind == HARD:
            hard = self._hard
            return LayerTruth(kind, hard.visible, None, 1, footprint, hard.times_ms, self._hard_cached)
        if kind in SAMPLED:
            get = self._store.get_soft if kind == SOFT else self._store.get_pixel
            found, cached = get(light, self._sample_count)
            return LayerTruth(kind, found.visibility, found.error, found.samples, footprint, found.times_ms, cached)
        filtered, cached = self._store.get_filtered(
            self._captured, layer, footprint, self._sample_count, self._classes.comparable
        )
        times_ms = {"filter": filtered.time_ms}
        return LayerTruth(kind, filtered.visibility, filtered.error, filtered.samples, footprint, times_ms, cached)
