# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measuring the layers of one light in one frame, for the batch's verb compare: records, pictures, page entries."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .batch_border import BorderSource, describe_border, make_texel_function
from .batch_causes import CauseSource
from .batch_render import describe_layer
from .batch_truth import HARD, PIXEL, SAMPLED, LayerTruth
from .capture import CapturedFrame, CapturedLayer
from .compare import flip
from .compare.footprint import compute_sun_extent, compute_texel_footprint_px
from .compare.measures import LIT_THRESHOLD, LayerMeasures, count_border_pixels, measure_layer
from .compare.pictures import make_difference_png, make_layer_png, make_truth_png
from .compare.pixels import PixelClasses
from .compare.report import LightEntry, TechniqueEntry
from .compare.true_border import TrueBorder
from .compare.value_pictures import make_error_png, make_value_png
from .truth import LightTruth

# Writes a PNG under a name made of parts, and returns the file's name.
PictureWriter = Callable[..., str]


@dataclass
class _Shared:
    """What layers that are compared with the same truth have in common."""

    border: TrueBorder
    border_samples: int
    picture: str
    entry: LightEntry


class LightMeasurer:
    """Of one light in one frame. `hard`: its hard truth and whether it came from the cache. `causes`: what sorts wrong
    pixels; None: they are not sorted."""

    def __init__(
        self,
        captured: CapturedFrame,
        hard: tuple[LightTruth, bool],
        classes: PixelClasses,
        borders: BorderSource,
        *,
        light: int,
        write_picture: PictureWriter,
        again_ms: list[float | None],
        causes: CauseSource | None = None,
    ) -> None:
        self._captured, self._classes, self._borders = captured, classes, borders
        self._hard, self._hard_cached = hard
        self._light = captured.snapshot.lights[light]
        self._write_picture, self._again_ms, self._causes = write_picture, again_ms, causes
        self._shared: dict[int, tuple[LayerTruth, _Shared]] = {}  # the truth is kept: its id must stay its own
        self._layer_pictures: dict[int, tuple[bytes, str]] = {}
        self._sun_extent = 0.0
        if self._light.kind == "SUN":
            seen = captured.aux["position"][captured.coverage > 0.5]
            self._sun_extent = compute_sun_extent(seen, self._get_origin(), self._light)
        self.records: list[dict[str, Any]] = []

    @property
    def entries(self) -> list[LightEntry]:
        """For the page: one for each truth, in the order of their first use."""
        return [shared.entry for _, shared in self._shared.values()]

    def measure(self, layer: CapturedLayer, truth: LayerTruth) -> None:
        """Adds a layer's record and its entry. Raises TruthError."""
        shared = self._share(layer, truth)
        comparable = self._classes.comparable
        visibility = layer.channels["visibility"]
        measures = self._measure(layer, truth, shared.border)
        if truth.kind == HARD:
            difference_png = make_difference_png(truth.values, self._classes, measures.faults)
        else:
            difference_png = make_error_png(visibility, truth.values, self._classes)
        layer_png, layer_picture = self._draw_layer(layer)
        first = all(record["technique"] != layer.technique for record in self.records)
        # Filtered truths are not Cycles' own; its time for such a picture is that of the mask that they filter.
        times_ms, cached = self._hard.times_ms, self._hard_cached
        if truth.kind in SAMPLED:
            times_ms, cached = truth.times_ms, truth.cached
        record = {
            **describe_layer(layer, self._light.kind, self._captured.frame, self._captured.view_layer),
            "again_ms": self._again_ms[self._captured.layers.index(layer)],
            "truth": truth.describe(comparable),
            "measures": measures.values,
            "border": describe_border(measures, shared.border_samples),
            "flip": flip.compute_mean_flip(visibility, truth.values, comparable),
            "pixel_count": measures.pixel_count,
            "true_border_pixels": count_border_pixels(truth.values >= LIT_THRESHOLD, comparable),
            "excluded": self._classes.count_excluded(),
            "truth_undecided": self._hard.undecided_count,
            "truth_ms": {stage: round(value, 4) for stage, value in sum_up(times_ms).items()},
            "truth_cached": cached,
            "layer_picture": layer_picture,
            "truth_picture": shared.picture,
            "difference_picture": self._write_picture(
                difference_png, self._light.name, layer.technique, "difference", "" if first else truth.kind
            ),
        }
        if self._causes is not None and truth.kind == HARD:
            record["causes"] = self._causes.describe(layer, truth.values, comparable)
        self.records.append(record)
        shared.entry.techniques.append(TechniqueEntry(record, layer_png, difference_png))

    def _share(self, layer: CapturedLayer, truth: LayerTruth) -> _Shared:
        """The truth's border, picture and entry, made with the first layer that is compared with it."""
        if id(truth) not in self._shared:
            name = self._light.name
            if truth.kind == HARD:
                border = self._borders.get_hard(self._light, truth.values, self._classes)
                samples = self._borders.samples
                png = make_truth_png(truth.values, self._classes)
                parts = (name, "truth")
            else:
                # As wide as a pixel, the values of a pixel truth hold the border's place as they are.
                border = self._borders.get_of_values(truth.values, self._classes, smooth=truth.kind != PIXEL)
                samples, png = 1, make_value_png(truth.values, self._classes)
                parts = (name, "truth", truth.kind) if truth.kind in SAMPLED else (name, layer.technique, "truth")
            entry = LightEntry(
                name, self._light.kind, self._captured.frame, png, truth=truth.kind, truth_label=truth.get_label()
            )
            self._shared[id(truth)] = truth, _Shared(border, samples, self._write_picture(png, *parts), entry)
        return self._shared[id(truth)][1]

    def _draw_layer(self, layer: CapturedLayer) -> tuple[bytes, str]:
        if layer.job_index not in self._layer_pictures:
            png = make_layer_png(layer.channels["visibility"])
            path = self._write_picture(png, self._light.name, layer.technique, "layer")
            self._layer_pictures[layer.job_index] = png, path
        return self._layer_pictures[layer.job_index]

    def _measure(self, layer: CapturedLayer, truth: LayerTruth, border: TrueBorder) -> LayerMeasures:
        captured, snapshot = self._captured, self._captured.snapshot
        map_size = layer.parameters.get("map_size")

        def compute_footprint(rows: NDArray[np.integer], columns: NDArray[np.integer]) -> NDArray[np.float64]:
            return compute_texel_footprint_px(
                captured.aux["position"][rows, columns],
                captured.aux["normal"][rows, columns],
                self._get_origin(),
                camera=snapshot.camera,
                width=snapshot.render.width,
                height=snapshot.render.height,
                light=self._light,
                map_size=int(map_size),
                sun_extent=self._sun_extent,
            )

        return measure_layer(
            layer.channels["visibility"],
            truth.values,
            self._classes.comparable,
            facing_away=self._classes.facing_away,
            footprint_px=compute_footprint if map_size else None,
            border=border,
            texels=make_texel_function(captured, layer, self._light),
        )

    def _get_origin(self) -> NDArray[np.float64]:
        return np.asarray(self._captured.camera_position, dtype=np.float64)


def sum_up(times_ms: dict[str, float]) -> dict[str, float]:
    """With "total": what Cycles needs for one light's mask."""
    return {**times_ms, "total": sum(times_ms.values())}
