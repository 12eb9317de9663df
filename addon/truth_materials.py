# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The materials that the truth puts in place of a scene's own, and the objects that they must not bring to light."""

from __future__ import annotations

from typing import Any

import bpy

from .materials import Opacity, examine
from .scene_guard import SceneGuard

HIDDEN_PREFIX = ".shadow_layers_truth"  # names that begin with a dot are hidden in Blender's menus


def find_transparent_objects(override: bpy.types.Material | None) -> set[bpy.types.Object]:
    """Those that the layers leave out because every material is fully transparent. `override`: the view layer's own,
    which stands for all. Instancers stay: the switches of their rays would hide their instances."""
    facts: dict[Any, bool] = {}

    def is_transparent(material: bpy.types.Material | None) -> bool:
        if material not in facts:
            facts[material] = examine(material).opacity is Opacity.TRANSPARENT
        return facts[material]

    found = set()
    for thing in bpy.data.objects:
        materials = [override] if override is not None else [slot.material for slot in thing.material_slots]
        if materials and not thing.is_instancer and all(is_transparent(material) for material in materials):
            found.add(thing)
    return found


def make_material(guard: SceneGuard, name: str, shader: str) -> tuple[Any, Any, Any]:
    """A material of one shader node, removed at the end; with that node and the node of the geometry."""
    material = guard.made(bpy.data.materials, bpy.data.materials.new(HIDDEN_PREFIX + name))
    if bpy.app.version < (5, 0, 0):  # always on from then on
        material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    made, geometry, output = (nodes.new(kind) for kind in (shader, "ShaderNodeNewGeometry", "ShaderNodeOutputMaterial"))
    material.node_tree.links.new(made.outputs[0], output.inputs["Surface"])
    return material, made, geometry


def make_position_material(guard: SceneGuard) -> bpy.types.Material:
    """Shows the position in world axes as its colour."""
    material, emission, geometry = make_material(guard, "_position", "ShaderNodeEmission")
    material.node_tree.links.new(geometry.outputs["Position"], emission.inputs["Color"])
    # Not a light: Cycles would gather every triangle of the scene for sampling.
    if hasattr(material.cycles, "emission_sampling"):
        material.cycles.emission_sampling = "NONE"
    elif hasattr(material.cycles, "sample_as_light"):
        material.cycles.sample_as_light = False
    return material


def make_diffuse_material(guard: SceneGuard) -> bpy.types.Material:
    """White and diffuse about the geometric normal: smooth shading must not darken faces that see the light."""
    return make_white_material(guard, "_diffuse", "ShaderNodeBsdfDiffuse")


def make_translucent_material(guard: SceneGuard) -> bpy.types.Material:
    """White, and lit from behind alone: shows whether faces that are turned away from a light are its receivers."""
    return make_white_material(guard, "_translucent", "ShaderNodeBsdfTranslucent")


def make_white_material(guard: SceneGuard, name: str, shader: str) -> bpy.types.Material:
    material, scatter, geometry = make_material(guard, name, shader)
    scatter.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    material.node_tree.links.new(geometry.outputs["True Normal"], scatter.inputs["Normal"])
    return material
