# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a scene is set up for the truth's renders (docs/measures.md). All of it is undone by the guard."""

from __future__ import annotations

import contextlib

import bpy

from .picture import literal_path
from .scene_guard import SceneGuard
from .truth_materials import find_transparent_objects

# The smallest that Cycles takes. With a Gaussian of this width samples lie within 0.002 pixels of the centre.
FILTER_WIDTH_PX = 0.01


def set_up_scene(
    guard: SceneGuard, scene: bpy.types.Scene, layer: bpy.types.ViewLayer, size: tuple[int, int], threads: int
) -> None:
    """Only that view layer's geometry, in a picture of that size; `threads` 0: as the file has it."""
    render = scene.render
    guard.set(scene, "world", None)
    guard.set_if_there(layer, "world_override", None)
    guard.set(layer, "use", True)
    guard.set(layer, "use_pass_combined", True)
    guard.set(layer, "samples", 0)
    # The override is set anew for each render; this remembers the user's.
    user_override = layer.material_override
    guard.on_exit(lambda: setattr(layer, "material_override", user_override))
    guard.set(render, "engine", "CYCLES")
    guard.set(render, "resolution_x", size[0])
    guard.set(render, "resolution_y", size[1])
    guard.set(render, "resolution_percentage", 100)
    guard.set(render, "film_transparent", True)
    for name in (
        "use_border", "use_multiview", "use_compositing", "use_sequencer", "use_freestyle", "use_motion_blur",
        "use_persistent_data", "use_stamp",
    ):  # fmt: skip
        guard.set_if_there(render, name, False)
    if threads:
        guard.set(render, "threads_mode", "FIXED")
        guard.set(render, "threads", threads)
    if scene.camera.type == "CAMERA":
        guard.set(scene.camera.data.dof, "use_dof", False)


def set_up_cycles(guard: SceneGuard, scene: bpy.types.Scene) -> None:
    """One sample at the pixel's centre, and the light that comes straight from a lamp."""
    cycles = scene.cycles
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


def set_up_jitter(guard: SceneGuard, scene: bpy.types.Scene) -> None:
    """One sample somewhere in the pixel's square, by the seed. It is the second that Cycles would take, for the first
    lies at the centre, whatever the seed."""
    cycles = scene.cycles
    guard.set(cycles, "pixel_filter_type", "BOX")
    guard.set(cycles, "sample_offset", 1)
    if guard.set_if_there(cycles, "use_sample_subset", True):  # older versions have the offset alone
        guard.set(cycles, "sample_subset_length", 1)
        guard.set(cycles, "samples", 2)


def set_up_output(guard: SceneGuard, scene: bpy.types.Scene, path: str) -> None:
    """A float picture of one layer, to that path."""
    render, image = scene.render, scene.render.image_settings
    guard.set(render, "filepath", literal_path(render, path))
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


def set_up_objects(guard: SceneGuard, layer: bpy.types.ViewLayer) -> None:
    """Geometry as the layers have it: nothing transparent, no offsets of shadow rays, no finer subdivision."""
    transparent = find_transparent_objects(layer.material_override)
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
