# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's render passes: announcing them, writing pixels into them, and what the EXR header says of them."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy as np

from . import bridge, jobs
from .names import COVERAGE_PASS
from .snapshot import SceneSnapshot

# channels -> (channel ids, pass type). VALUE passes get no view transform in PNG outputs, which a mask must not.
_LAYOUT = {1: ("X", "VALUE"), 3: ("RGB", "COLOR"), 4: ("RGBA", "COLOR")}


def announce(engine: Any, scene: Any, view_layer: Any) -> None:
    """Registers the passes of a view layer (compositor sockets and render result). Cheap and without GL: Blender calls
    it whenever it rebuilds the Render Layers node. Without the native module only the fixed passes are there."""
    engine.register_pass(scene, view_layer, "Combined", 4, "RGBA", "COLOR")
    engine.register_pass(scene, view_layer, COVERAGE_PASS, 1, *_LAYOUT[1])
    if bridge.available() is not None:
        return
    lights = jobs.predicted_lights(scene, view_layer)
    try:
        planned = jobs.plan_passes([light.name for light in lights], jobs.jobs_for(scene, view_layer, lights))
    except bridge.ShadowLayersError:
        return  # the render reports it
    for item in planned:
        engine.register_pass(scene, view_layer, item.name, item.channels, *_LAYOUT[item.channels])


def plan(snapshot: SceneSnapshot) -> list[jobs.PlannedPass]:
    """The passes of an exported scene."""
    return jobs.plan_passes([light.name for light in snapshot.lights], snapshot.jobs)


def add_all(engine: Any, planned: Iterable[jobs.PlannedPass], view_layer: str) -> None:
    """Adds the passes to the render's result, before its `begin_result`. Announced ones are there already and stay
    single; those of lights that only the evaluated scene has (geometry nodes, particles) come into being."""
    for item in planned:
        engine.add_pass(item.name, item.channels, _LAYOUT[item.channels][0], layer=view_layer)


def write(passes: Any, name: str, pixels: np.ndarray) -> None:
    """Writes a picture (h, w) or (h, w, c), row 0 at the bottom, into the pass of that name. Raises KeyError without
    one, ShadowLayersError if sizes differ."""
    target = passes[name]
    channels = target.channels
    # foreach_set wants C-contiguous float32; anything else leaves garbage in the pass.
    flat = np.ascontiguousarray(pixels, np.float32).reshape(-1, channels)
    try:
        target.rect.foreach_set(flat if channels > 1 else flat.ravel())
    except TypeError as error:
        try:
            target.rect.foreach_set(flat.ravel())  # newer versions take the ravelled form
        except TypeError:
            raise bridge.ShadowLayersError(f'pass "{name}" does not take {pixels.shape} pixels: {error}') from error


def stamp(result: Any, snapshot: SceneSnapshot, planned: Iterable[jobs.PlannedPass], info: dict[str, Any]) -> None:
    """Puts light, technique and settings of each pass, and the versions, into the picture's metadata."""
    view_layer = snapshot.source.get("view_layer", "")
    result.stamp_data_add_field("shadow_layers.version", f"{info['version']} ({info['revision']})")
    result.stamp_data_add_field("shadow_layers.gl", f"{info.get('backend', '')}: {info.get('gl_renderer', '')}")
    settings = {
        "samples": snapshot.render.samples,
        "filter": snapshot.render.filter,
        "filter_width": snapshot.render.filter_width,
    }
    result.stamp_data_add_field(f"shadow_layers.render.{view_layer}", json.dumps(settings))
    for item in planned:
        job = snapshot.jobs[item.job]
        entry = {
            "light": snapshot.lights[job.light].name,
            "technique": job.technique,
            "output": item.output,
            "settings": job.parameters,
        }
        result.stamp_data_add_field(
            f"shadow_layers.pass.{view_layer}.{item.name}", json.dumps(entry, ensure_ascii=False)
        )
