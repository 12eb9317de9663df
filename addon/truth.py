# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles as ground truth: per light, which pixels' centres the light reaches.

Visibility is the ratio of two renders, with and without shadows, of a white diffuse scene with that one light. Hard:
the light is made a point or a parallel beam, and each ratio is 0 or 1 exactly. Soft: it keeps its size, of which many
samples are taken. A third render, of an emission shader that shows the position, says which surface Cycles sees. All
samples lie at the pixel's centre. docs/measures.md holds what was measured for this.

Everything is put back when the `with` block ends; the scene must not be edited meanwhile.
"""

from __future__ import annotations

import contextlib
import math
import os
import tempfile
import time
from collections.abc import Iterator

import bpy
import numpy as np
from numpy.typing import NDArray

from .light_export import object_name
from .scene_guard import SceneGuard
from .truth_lights import (
    get_shadow_switch,
    is_bounded,
    make_front_light,
    make_hard_light,
    make_soft_light,
    set_shadow_switch,
)
from .truth_materials import (
    HIDDEN_PREFIX,
    make_diffuse_material,
    make_position_material,
    make_translucent_material,
)
from .truth_pictures import (
    LightTruth,
    SampledTruth,
    TruthError,
    TruthSurface,
    average_blocks,
    compute_light_truth,
    compute_pixel_truth,
    compute_sample_visibility,
    compute_soft_truth,
    load_pixels,
)
from .truth_setup import set_up_cycles, set_up_jitter, set_up_objects, set_up_output, set_up_scene

# Part of every cache key: raise it when what is rendered changes.
TRUTH_VERSION = 2
# Truths of many samples are rendered at least this many times with different seeds: what they differ by tells their
# standard error.
SEEDS = 4
# Samples of a whole picture at once: 1080p at 3 x 3. Cycles holds four floats for each.
MOST_SAMPLES = 20_000_000


class CyclesTruth:
    """Renders the truth of a scene at its current frame and camera.

        with CyclesTruth(scene, view_layer, 1280, 720) as truth:
            surface = truth.render_surface()
            shadow = truth.render_light("Sun")

    Changes of the frame between two calls are followed.
    """

    def __init__(
        self, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, width: int, height: int, threads: int = 0
    ) -> None:
        self._scene, self._view_layer = scene, view_layer
        self._width, self._height = width, height
        self._threads = threads
        self._stack = contextlib.ExitStack()

    def __enter__(self) -> CyclesTruth:
        if self._scene.camera is None:
            raise TruthError(
                f'scene "{self._scene.name}" has no camera: choose one in its properties, or give --camera'
            )
        if not hasattr(self._scene, "cycles"):
            raise TruthError(
                "there is no Cycles to compare with: switch the add-on Cycles Render Engine on in Preferences > Add-ons"
            )
        with contextlib.ExitStack() as stack:
            self._folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="shadow_layers_truth_"))
            guard = stack.enter_context(SceneGuard())
            self._path = os.path.join(self._folder, "truth.exr")
            set_up_scene(guard, self._scene, self._view_layer, (self._width, self._height), self._threads)
            set_up_cycles(guard, self._scene)
            set_up_output(guard, self._scene, self._path)
            set_up_objects(guard, self._view_layer)
            self._position_material = make_position_material(guard)
            self._diffuse_material = make_diffuse_material(guard)
            self._translucent_material = make_translucent_material(guard)
            self._dark_light = guard.made(bpy.data.lights, bpy.data.lights.new(HIDDEN_PREFIX + "_dark", "POINT"))
            self._dark_light.energy = 0.0
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.__exit__(*error)

    def render_surface(self) -> TruthSurface:
        """Position and coverage of what is seen. Raises TruthError."""
        with SceneGuard() as guard:
            self._darken_lights(guard, None)
            pixels, time_ms = self._render(self._position_material)
        return TruthSurface(np.ascontiguousarray(pixels[..., :3]), pixels[..., 3] > 0.5, time_ms)

    def render_light(self, name: str) -> LightTruth:
        """The hard shadow of the light object of that name. Raises TruthError."""
        light_object = find_light_object(name)
        with SceneGuard() as guard:
            light = make_hard_light(guard, light_object)
            shadowed, open_sky, times_ms = self._render_pair(guard, light_object, light)
        return compute_light_truth(shadowed[..., 0], open_sky[..., 0], times_ms)

    def render_reached(self, name: str) -> tuple[NDArray[np.bool_], float]:
        """The pixels (h, w) that any light of that light object reaches, made hard, and the wall time in ms: half the
        work of `render_light`, where nothing more is wanted. Raises TruthError."""
        light_object = find_light_object(name)
        with SceneGuard() as guard:
            self._darken_lights(guard, light_object)
            guard.set(light_object, "data", make_hard_light(guard, light_object))
            guard.set(light_object, "visible_diffuse", True)
            pixels, time_ms = self._render(self._diffuse_material)
        return pixels[..., 0] > 0.0, time_ms

    def render_soft_light(self, name: str, sample_count: int) -> SampledTruth:
        """The shadow of that light object in its real size. `sample_count` per pixel is rounded up to a multiple of
        SEEDS. Raises TruthError."""
        pairs, times_ms = [], {"shadows_on": 0.0, "shadows_off": 0.0}
        samples = -(-sample_count // SEEDS)
        with SceneGuard() as guard:
            for _ in self._change_seeds(guard, SEEDS):
                *pair, times = self.render_soft_pair(name, samples)
                pairs.append(pair)
                times_ms = {stage: times_ms[stage] + times[stage] for stage in times_ms}
        return compute_soft_truth(np.array(pairs), samples * SEEDS, times_ms)

    def render_soft_pair(
        self, name: str, sample_count: int
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], dict[str, float]]:
        """That light object in its real size, with and without shadows, (h, w) each, and the times: one render each, by
        the scene's seed. Raises TruthError."""
        light_object = find_light_object(name)
        with SceneGuard() as guard:
            light = make_soft_light(guard, light_object)
            guard.set(light_object, "visible_camera", False)
            guard.set(self._scene.cycles, "samples", sample_count)
            shadowed, open_sky, times = self._render_pair(guard, light_object, light)
        return shadowed[..., 0], open_sky[..., 0], times

    def render_pixel_light(self, name: str, sample_count: int) -> SampledTruth:
        """The hard shadow of that light object, averaged over each pixel's square: at one place at random in each cell
        of a grid, of which there are several with different places. `sample_count` per pixel is rounded up to whole
        grids. Each place is a pixel of a larger picture, of one sample, so that its mask is known by itself. Raises
        TruthError."""
        light_object = find_light_object(name)
        across, grids = choose_grids(sample_count, self._width, self._height)
        means, lit = [], np.zeros((self._height, self._width), dtype=bool)
        times_ms = {"shadows_on": 0.0, "shadows_off": 0.0}
        with SceneGuard() as guard:
            light = make_front_light(guard, light_object)
            set_up_jitter(guard, self._scene)
            guard.set(self._scene.render, "resolution_x", self._width * across)
            guard.set(self._scene.render, "resolution_y", self._height * across)
            for _ in self._change_seeds(guard, grids):
                with SceneGuard() as inner:
                    shadowed, open_sky, times = self._render_pair(inner, light_object, light)
                    unreached = self._render_unreached(light_object, light, open_sky)
                visible = compute_sample_visibility(shadowed[..., 0], open_sky[..., 0], unreached)
                means.append(average_blocks(visible, across))
                lit |= average_blocks(open_sky[..., 0] > 0.0, across) > 0.0
                times_ms = {stage: times_ms[stage] + times[stage] for stage in times_ms}
        return compute_pixel_truth(np.array(means), lit, across * across * grids, times_ms)

    def _render_unreached(
        self, light_object: bpy.types.Object, light: bpy.types.Light, open_sky: NDArray[np.float32]
    ) -> NDArray[np.bool_]:
        """Which samples see no receiver of the light, whose shadows are off: background, outside its cone, not linked
        to it."""
        if not is_bounded(light_object, light):
            return open_sky[..., 3] <= 0.5
        casts_shadow = get_shadow_switch(light)
        set_shadow_switch(light, False)
        behind, _ = self._render(self._translucent_material)
        set_shadow_switch(light, casts_shadow)
        return (open_sky[..., 0] <= 0.0) & (behind[..., 0] <= 0.0)

    def _change_seeds(self, guard: SceneGuard, count: int) -> Iterator[int]:
        """Gives Cycles one seed after another."""
        cycles = self._scene.cycles
        first_seed = cycles.seed
        guard.on_exit(lambda: setattr(cycles, "seed", first_seed))
        for seed in range(count):
            cycles.seed = first_seed + seed
            yield seed

    def _render_pair(
        self, guard: SceneGuard, light_object: bpy.types.Object, light: bpy.types.Light
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], dict[str, float]]:
        """With and without shadows, (h, w, 4) each, and the times; `light` in place of the object's own."""
        casts_shadow = get_shadow_switch(light)
        self._darken_lights(guard, light_object)
        guard.set(light_object, "data", light)
        guard.set(light_object, "visible_diffuse", True)
        shadowed, on_ms = self._render(self._diffuse_material)
        set_shadow_switch(light, False)
        open_sky, off_ms = self._render(self._diffuse_material)
        set_shadow_switch(light, casts_shadow)
        return shadowed, open_sky, {"shadows_on": on_ms, "shadows_off": off_ms}

    # ---- lights

    def _darken_lights(self, guard: SceneGuard, kept: bpy.types.Object | None) -> None:
        """Gives every other light object a light without energy, which Cycles leaves out, instances too."""
        for thing in bpy.data.objects:
            if thing.type == "LIGHT" and thing != kept:
                guard.set(thing, "data", self._dark_light)

    # ---- rendering

    def _render(self, material: bpy.types.Material) -> tuple[NDArray[np.float32], float]:
        """Renders with all materials replaced. (h, w, 4) float32, row 0 at the bottom, and the wall time."""
        self._view_layer.material_override = material
        with contextlib.suppress(FileNotFoundError):
            os.unlink(self._path)
        start = time.perf_counter()
        try:
            bpy.ops.render.render(write_still=True, layer=self._view_layer.name, scene=self._scene.name)
        except RuntimeError as error:
            raise TruthError(f"Cycles can't render the truth: {str(error).strip()}") from error
        time_ms = (time.perf_counter() - start) * 1000.0
        if not os.path.exists(self._path):
            raise TruthError(f"Cycles wrote no picture to {self._folder}: see its messages above, and free disk space")
        render = self._scene.render
        return load_pixels(self._path, render.resolution_x, render.resolution_y), time_ms


def choose_grids(sample_count: int, width: int, height: int) -> tuple[int, int]:
    """Samples across a pixel in one grid, and the number of grids: squares of not more than MOST_SAMPLES in the whole
    picture, at least SEEDS of them."""
    most = min(sample_count / SEEDS, MOST_SAMPLES / (width * height))
    across = max(1, math.isqrt(int(most)))
    return across, max(SEEDS, math.ceil(sample_count / across**2))


def find_light_object(name: str) -> bpy.types.Object:
    """The light object of that name. Raises TruthError."""
    lights = (thing for thing in bpy.data.objects if thing.type == "LIGHT")
    found = next((thing for thing in lights if object_name(thing) == name), None)
    if found is None:
        raise TruthError(
            f'"{name}" is no light object: instanced lights have no truth yet; make them real objects, or choose '
            "others with --lights"
        )
    return found
