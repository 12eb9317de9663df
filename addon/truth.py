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
import os
import tempfile
import time

import bpy
import numpy as np
from numpy.typing import NDArray

from .light_export import object_name
from .picture import literal_path
from .scene_guard import SceneGuard
from .truth_lights import get_shadow_switch, make_hard_light, make_soft_light, set_shadow_switch
from .truth_materials import (
    HIDDEN_PREFIX,
    find_transparent_objects,
    make_diffuse_material,
    make_position_material,
)
from .truth_pictures import (
    LightTruth,
    SoftTruth,
    TruthError,
    TruthSurface,
    compute_light_truth,
    compute_soft_truth,
    load_pixels,
)

# Part of every cache key: raise it when what is rendered changes.
TRUTH_VERSION = 2
# The smallest that Cycles takes. With a Gaussian of this width samples lie within 0.002 pixels of the centre.
FILTER_WIDTH_PX = 0.01
# The soft truth is rendered this many times with different seeds: what they differ by tells its standard error.
SOFT_RENDERS = 4


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
            self._set_up_scene(guard)
            self._set_up_cycles(guard)
            self._set_up_output(guard)
            self._set_up_objects(guard)
            self._position_material = make_position_material(guard)
            self._diffuse_material = make_diffuse_material(guard)
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
        return compute_light_truth(shadowed, open_sky, times_ms)

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

    def render_soft_light(self, name: str, sample_count: int) -> SoftTruth:
        """The shadow of that light object in its real size. `sample_count` per pixel is rounded up to a multiple of
        SOFT_RENDERS. Raises TruthError."""
        light_object = find_light_object(name)
        cycles = self._scene.cycles
        pairs, times_ms = [], {"shadows_on": 0.0, "shadows_off": 0.0}
        with SceneGuard() as guard:
            light = make_soft_light(guard, light_object)
            guard.set(light_object, "visible_camera", False)
            guard.set(cycles, "samples", -(-sample_count // SOFT_RENDERS))
            first_seed = cycles.seed
            guard.on_exit(lambda: setattr(cycles, "seed", first_seed))
            for seed in range(SOFT_RENDERS):
                cycles.seed = first_seed + seed
                with SceneGuard() as inner:
                    *pair, times = self._render_pair(inner, light_object, light)
                pairs.append(pair)
                times_ms = {stage: times_ms[stage] + times[stage] for stage in times_ms}
            samples = cycles.samples * SOFT_RENDERS
        return compute_soft_truth(np.array(pairs), samples, times_ms)

    def _render_pair(
        self, guard: SceneGuard, light_object: bpy.types.Object, light: bpy.types.Light
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], dict[str, float]]:
        """With and without shadows, (h, w) each, and the times; `light` in place of the object's own."""
        casts_shadow = get_shadow_switch(light)
        self._darken_lights(guard, light_object)
        guard.set(light_object, "data", light)
        guard.set(light_object, "visible_diffuse", True)
        shadowed, on_ms = self._render(self._diffuse_material)
        set_shadow_switch(light, False)
        open_sky, off_ms = self._render(self._diffuse_material)
        set_shadow_switch(light, casts_shadow)
        return shadowed[..., 0], open_sky[..., 0], {"shadows_on": on_ms, "shadows_off": off_ms}

    # ---- setting up

    def _set_up_scene(self, guard: SceneGuard) -> None:
        scene, layer, render = self._scene, self._view_layer, self._scene.render
        guard.set(scene, "world", None)
        guard.set_if_there(layer, "world_override", None)
        guard.set(layer, "use", True)
        guard.set(layer, "use_pass_combined", True)
        guard.set(layer, "samples", 0)
        # The override is set anew for each render; this remembers the user's.
        user_override = layer.material_override
        guard.on_exit(lambda: setattr(layer, "material_override", user_override))
        guard.set(render, "engine", "CYCLES")
        guard.set(render, "resolution_x", self._width)
        guard.set(render, "resolution_y", self._height)
        guard.set(render, "resolution_percentage", 100)
        guard.set(render, "film_transparent", True)
        for name in (
            "use_border", "use_multiview", "use_compositing", "use_sequencer", "use_freestyle", "use_motion_blur",
            "use_persistent_data", "use_stamp",
        ):  # fmt: skip
            guard.set_if_there(render, name, False)
        if self._threads:
            guard.set(render, "threads_mode", "FIXED")
            guard.set(render, "threads", self._threads)
        if scene.camera.type == "CAMERA":
            guard.set(scene.camera.data.dof, "use_dof", False)

    def _set_up_cycles(self, guard: SceneGuard) -> None:
        cycles = self._scene.cycles
        guard.set(cycles, "device", "CPU")
        guard.set(cycles, "samples", 1)
        guard.set(cycles, "pixel_filter_type", "GAUSSIAN")
        guard.set(cycles, "filter_width", FILTER_WIDTH_PX)
        guard.set(cycles, "film_exposure", 1.0)
        for name in (
            "max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "volume_bounces",
            "sample_clamp_direct", "sample_clamp_indirect", "light_sampling_threshold", "time_limit", "sample_offset",
            "min_light_bounces", "min_transparent_bounces", "seed",
        ):  # fmt: skip
            guard.set_if_there(cycles, name, 0)
        for name in (
            "use_adaptive_sampling", "use_denoising", "use_fast_gi", "use_light_tree", "use_guiding",
            "use_animated_seed", "shading_system",
        ):  # fmt: skip
            guard.set_if_there(cycles, name, False)
        # Adaptive subdivision would refine what the snapshot holds at render level (from 5.0 on see the modifiers).
        guard.set_if_there(cycles, "feature_set", "SUPPORTED")

    def _set_up_output(self, guard: SceneGuard) -> None:
        render, image = self._scene.render, self._scene.render.image_settings
        self._path = os.path.join(self._folder, "truth.exr")
        guard.set(render, "filepath", literal_path(render, self._path))
        for name in ("use_file_extension", "use_overwrite"):
            guard.set(render, name, True)
        guard.set(render, "use_placeholder", False)
        # What a format allows depends on it, so all of it is remembered first and set again in Blender's order.
        names = ("media_type", "file_format", "color_mode", "color_depth", "exr_codec", "color_management")
        user = {name: getattr(image, name) for name in names if hasattr(image, name)}

        def restore() -> None:
            for name, value in user.items():
                with contextlib.suppress(TypeError):  # a codec that the user's format doesn't have
                    setattr(image, name, value)

        guard.on_exit(restore)
        if "media_type" in user:
            image.media_type = "IMAGE"
        image.file_format = "OPEN_EXR"
        image.color_mode = "RGBA"
        image.color_depth = "32"
        image.exr_codec = "NONE"
        if "color_management" in user:
            image.color_management = "FOLLOW_SCENE"

    def _set_up_objects(self, guard: SceneGuard) -> None:
        transparent = find_transparent_objects(self._view_layer.material_override)
        for thing in bpy.data.objects:
            if thing.type == "LIGHT":
                continue
            if thing in transparent:
                guard.set(thing, "visible_camera", False)
                guard.set(thing, "visible_shadow", False)
            # Blender moved these out of the Cycles add-on's properties; each version has one of the two places.
            for owner in (thing, getattr(thing, "cycles", None)):
                guard.set_if_there(owner, "shadow_terminator_geometry_offset", 0.0)
                guard.set_if_there(owner, "shadow_terminator_shading_offset", 0.0)
                guard.set_if_there(owner, "shadow_terminator_offset", 0.0)
                guard.set_if_there(owner, "is_shadow_catcher", False)
            for modifier in thing.modifiers:
                guard.set_if_there(modifier, "use_adaptive_subdivision", False)

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
        return load_pixels(self._path, self._width, self._height), time_ms


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
