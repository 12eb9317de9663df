# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The filtered truth of a captured layer: the exact mask averaged over a square in the layer's own map."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .capture import CapturedFrame, CapturedLayer
from .compare.filtered_truth import compute_filtered_visibility
from .compare.light_bins import View, make_views
from .compare.light_squares import Footprint, Receivers
from .compare.sample_points import LATTICES
from .compare.scene_triangles import SceneTriangles, find_casters
from .truth_pictures import TruthError

# Part of every cache key: raise it when what is computed changes.
FILTERED_VERSION = 5


@dataclass(frozen=True)
class FilteredTruth:
    """The exact mask of a light without size, averaged over a square round each pixel. Row 0 at the bottom."""

    visibility: NDArray[np.float32]  # (h, w) 0 to 1; 1 where it was not wanted
    error: NDArray[np.float32]  # (h, w) its standard error
    samples: int  # per pixel
    sampled_count: int  # pixels that samples were taken of; the others were decided as a whole
    time_ms: float


def compute_filtered_truth(
    captured: CapturedFrame,
    triangles: SceneTriangles,
    layer: CapturedLayer,
    footprint: Footprint,
    sample_count: int,
    *,
    wanted: NDArray[np.bool_],
    threads: int = 0,
) -> FilteredTruth:
    """The truth at the pixels `wanted` (h, w), which must face the light. `captured` has the aux pictures "position"
    and "ids". Raises TruthError."""
    start = time.perf_counter()
    snapshot = captured.snapshot
    light = snapshot.lights[layer.job.light]
    views = [View(view["perspective"], view["texel_size"], view["view_from_world"]) for view in layer.views]
    if not views and not footprint.texels:
        views = make_views(light.kind, light.world_from_light)
    if not views and light.casts_shadow and wanted.any():
        raise TruthError(
            f'"{layer.technique}" has no shadow map for "{layer.light}", so that there is no square in the map to '
            "filter the truth over: choose another truth with --truth"
        )
    origin_ws = np.asarray(captured.camera_position, dtype=np.float64)
    ids = captured.aux["ids"][wanted]
    receivers = Receivers(
        captured.aux["position"][wanted].astype(np.float64) + origin_ws,
        triangles.find_triangles(ids[:, 0], ids[:, 1]),
        np.flatnonzero(wanted),
    )
    found = compute_filtered_visibility(
        triangles,
        find_casters(triangles, snapshot, light),
        views=views,
        receivers=receivers,
        footprint=footprint,
        sample_count=sample_count,
        threads=threads,
    )
    visibility, error = np.ones(wanted.shape, np.float32), np.zeros(wanted.shape, np.float32)
    visibility[wanted], error[wanted] = found.visibility, found.error
    samples = -(-sample_count // LATTICES) * LATTICES
    time_ms = (time.perf_counter() - start) * 1000.0
    return FilteredTruth(visibility, error, samples, found.sampled_count, time_ms)
