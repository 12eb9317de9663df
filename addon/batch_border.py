# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The true borders that the batch's verb compare measures shift and staircase against (docs/measures.md).

A truth of one sample per pixel knows a border only to the pixel. So a hard truth is rendered once more with several
samples across each pixel; a filtered or soft one has its border's place in its values.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .capture import CapturedFrame, CapturedLayer
from .compare.border import TexelFunction
from .compare.contour import smooth_noise, trace_contour
from .compare.footprint import compute_sun_extent, compute_texel_matrices, compute_view_positions
from .compare.measures import LIT_THRESHOLD, LayerMeasures
from .compare.pixels import PixelClasses, compute_pixel_size
from .compare.true_border import TrueBorder, find_usable
from .snapshot import LightData, SceneSnapshot
from .truth import MOST_SAMPLES
from .truth_store import TruthStore


def choose_samples(wanted: int, width: int, height: int) -> int:
    """Samples across a pixel: as many as wanted, or as the picture's size allows."""
    samples = wanted
    while samples > 1 and samples * samples * width * height > MOST_SAMPLES:
        samples -= 1
    return samples


def refine(snapshot: SceneSnapshot, samples: int) -> SceneSnapshot:
    """The same scene in a picture of `samples` times as many pixels each way."""
    render = snapshot.render
    width, height = render.width * samples, render.height * samples
    return dataclasses.replace(
        snapshot, render=dataclasses.replace(render, width=width, height=height, region=(0, 0, width, height))
    )


class BorderSource:
    """True borders of one frame's lights.

    `folder`, `enabled`, `threads` as for TruthStore; `samples` across a pixel. `notes` tells what went wrong.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        captured: CapturedFrame,
        *,
        samples: int = 3,
        folder: Path | None = None,
        enabled: bool = True,
        threads: int = 0,
    ) -> None:
        self._scene, self._view_layer, self._captured = scene, view_layer, captured
        self._store_options: dict[str, Any] = {"folder": folder, "enabled": enabled, "threads": threads}
        self._pixel_sizes: NDArray[np.float64] | None = None
        render = captured.snapshot.render
        self.samples = choose_samples(samples, render.width, render.height)
        self.notes: list[str] = []
        if self.samples < samples:
            self.notes.append(
                f"Borders are measured with {self.samples} samples of the truth across a pixel in place of {samples}, "
                "as the picture is so large: shift and staircase are coarser (--resolution makes it smaller)."
            )

    def get_hard(self, light: LightData, visible: NDArray[np.bool_], classes: PixelClasses) -> TrueBorder:
        """The border of a light's hard truth; `visible` (h, w) is that truth at the pixels' centres. With more than
        one sample Cycles renders, unless the cache has it; no other truth may be rendering. Raises TruthError."""
        if self.samples > 1:
            fine = refine(self._captured.snapshot, self.samples)
            with TruthStore(self._scene, self._view_layer, fine, **self._store_options) as store:
                visible = store.get_reached(light)
            self.notes += store.notes
        return TrueBorder(trace_contour(visible, self.samples), self._find_usable(classes))

    def get_of_values(self, values: NDArray[np.floating], classes: PixelClasses, *, smooth: bool = True) -> TrueBorder:
        """The border of a truth with values between 0 and 1, (h, w). `smooth`: of few samples over a wide penumbra, so
        that their noise would make it ragged."""
        if smooth:
            values = smooth_noise(values, classes.comparable)
        return TrueBorder(trace_contour(values), self._find_usable(classes), values >= LIT_THRESHOLD)

    def _find_usable(self, classes: PixelClasses) -> NDArray[np.bool_]:
        aux, snapshot = self._captured.aux, self._captured.snapshot
        if self._pixel_sizes is None:
            positions = np.asarray(aux["position"], dtype=np.float64)
            matrix = np.asarray(snapshot.camera.world_from_camera, dtype=np.float64)
            origin = np.asarray(self._captured.camera_position, dtype=np.float64)
            points_vs = compute_view_positions(positions.reshape(-1, 3), origin, matrix)
            sizes = compute_pixel_size(points_vs, snapshot.camera, snapshot.render.width, snapshot.render.height)
            self._pixel_sizes = sizes.reshape(positions.shape[:2])
        return find_usable(classes.comparable, aux["position"], aux["normal"], self._pixel_sizes)


def make_texel_function(captured: CapturedFrame, layer: CapturedLayer, light: LightData) -> TexelFunction | None:
    """How the texels of a layer's map lie in the picture; None: it has no map."""
    map_size = layer.parameters.get("map_size")
    if not map_size:
        return None
    snapshot = captured.snapshot
    origin = np.asarray(captured.camera_position, dtype=np.float64)
    extent = 0.0
    if light.kind == "SUN" and not layer.views:
        extent = compute_sun_extent(captured.aux["position"][captured.coverage > 0.5], origin, light)

    def compute(rows: NDArray[np.integer], columns: NDArray[np.integer]) -> NDArray[np.float64]:
        return compute_texel_matrices(
            captured.aux["position"][rows, columns],
            captured.aux["normal"][rows, columns],
            origin,
            camera=snapshot.camera,
            width=snapshot.render.width,
            height=snapshot.render.height,
            light=light,
            map_size=int(map_size),
            sun_extent=extent,
            views=layer.views,
        )

    return compute


def describe_border(measures: LayerMeasures, samples: int) -> dict[str, Any] | None:
    """What a record says of the border beside its measures: lengths in pixels, and pixels at the layer's border."""
    if measures.border is None:
        return None
    return {
        "samples": samples,
        **{f"{name}_px": round(value, 2) for name, value in measures.border.lengths_px.items()},
        "stray_pixels": measures.border.stray_pixels,
        "layer_border_pixels": measures.border.border_pixels,
    }
