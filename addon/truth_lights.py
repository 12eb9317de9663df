# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The lights that the truth puts in place of a scene's own: without size for the hard truth, with it for the soft."""

from __future__ import annotations

import math

import bpy

from .scene_guard import SceneGuard

# Any energy gives the same ratio; this one keeps float32 far from its limits between 1e-8 and 1e8 scene units.
LIGHT_ENERGY = 1000.0


def copy_light(guard: SceneGuard, light_object: bpy.types.Object) -> bpy.types.Light:
    """A copy, removed at the end, without colour, nodes, animation and falloff of its own."""
    light = guard.made(bpy.data.lights, light_object.data.copy())
    light.animation_data_clear()
    if light.use_nodes:
        light.use_nodes = False
    light.color = (1.0, 1.0, 1.0)
    light.energy = 1.0 if light.type == "SUN" else LIGHT_ENERGY
    for name in ("spot_blend", "exposure"):
        if hasattr(light, name):
            setattr(light, name, 0.0)
    for name in ("use_temperature", "use_soft_falloff"):
        if hasattr(light, name):
            setattr(light, name, False)
    return light


def make_hard_light(guard: SceneGuard, light_object: bpy.types.Object) -> bpy.types.Light:
    """A copy without size. An area light becomes a point at its centre."""
    light = copy_light(guard, light_object)
    if light.type == "AREA":
        casts_shadow = get_shadow_switch(light)
        light.type = "POINT"
        light = bpy.data.lights[light.name]  # a light's Python type follows its kind
        set_shadow_switch(light, casts_shadow)
        light.energy = LIGHT_ENERGY
        if hasattr(light, "use_soft_falloff"):
            light.use_soft_falloff = False
    for name in ("shadow_soft_size", "angle"):
        if hasattr(light, name):
            setattr(light, name, 0.0)
    return light


def make_front_light(guard: SceneGuard, light_object: bpy.types.Object) -> bpy.types.Light:
    """As `make_hard_light`, but what stands for an area light shines on the half of the space before it only, as the
    layers have it."""
    light = make_hard_light(guard, light_object)
    if light_object.data.type == "AREA":
        casts_shadow = get_shadow_switch(light)
        light.type = "SPOT"
        light = bpy.data.lights[light.name]
        set_shadow_switch(light, casts_shadow)
        light.shadow_soft_size, light.spot_size, light.spot_blend = 0.0, math.pi, 0.0
    return light


def make_soft_light(guard: SceneGuard, light_object: bpy.types.Object) -> bpy.types.Light:
    """A copy in its own size, which shines alike in all directions, and of which only light samples are taken: where a
    material's sample meets the light, a shadow can't be switched off."""
    light = copy_light(guard, light_object)
    if hasattr(light, "spread"):
        light.spread = math.pi
    own = getattr(light, "cycles", None)
    if own is not None and hasattr(own, "use_multiple_importance_sampling"):
        own.use_multiple_importance_sampling = False
    return light


def is_bounded(light_object: bpy.types.Object, light: bpy.types.Light) -> bool:
    """Whether there may be faces that are turned to the light and yet are none of its receivers: a cone, or a receiver
    collection (from 4.0 on). `light` stands in place of the object's own."""
    linking = getattr(light_object, "light_linking", None)
    return light.type == "SPOT" or getattr(linking, "receiver_collection", None) is not None


# ---- version differences


def get_shadow_switch(light: bpy.types.Light) -> bool:
    """Whether the light casts shadows. Before 4.2 Cycles had a switch of its own; the layers ask for both."""
    own = getattr(light, "cycles", None)
    return bool(light.use_shadow) and bool(getattr(own, "cast_shadow", True))


def set_shadow_switch(light: bpy.types.Light, casts_shadow: bool) -> None:
    """Sets all switches that this version has."""
    own = getattr(light, "cycles", None)
    if own is not None and hasattr(own, "cast_shadow"):
        own.cast_shadow = casts_shadow
    light.use_shadow = casts_shadow
