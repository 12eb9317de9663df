# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the export makes of materials: fully transparent faces are left out, partial transparency is named once."""

import bpy
import pytest
from addon_helpers import add_camera, add_light, add_object, exported, make_mesh


@pytest.fixture
def scene(fresh_scene):
    add_camera()
    add_light("SUN")
    return fresh_scene


def node_material(name: str) -> tuple[bpy.types.Material, bpy.types.NodeTree, bpy.types.Node]:
    """A material with nothing but an output."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    return material, tree, tree.nodes.new("ShaderNodeOutputMaterial")


def principled(name: str, alpha: float = 1.0, textured: bool = False) -> bpy.types.Material:
    material, tree, output = node_material(name)
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Alpha"].default_value = alpha
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    if textured:
        noise = tree.nodes.new("ShaderNodeTexNoise")
        tree.links.new(noise.outputs[0], shader.inputs["Alpha"])
    return material


def transparent(name: str, color=(1, 1, 1, 1)) -> bpy.types.Material:
    material, tree, output = node_material(name)
    shader = tree.nodes.new("ShaderNodeBsdfTransparent")
    shader.inputs["Color"].default_value = color
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def mixed(name: str, factor: float) -> bpy.types.Material:
    material, tree, output = node_material(name)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = factor
    clear, solid = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(solid.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return material


def grouped(name: str) -> bpy.types.Material:
    """Transparent BSDF inside a node group, behind a reroute."""
    group = bpy.data.node_groups.new("Inside", "ShaderNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    else:
        group.outputs.new("NodeSocketShader", "Shader")
    clear, end = group.nodes.new("ShaderNodeBsdfTransparent"), group.nodes.new("NodeGroupOutput")
    group.links.new(clear.outputs[0], end.inputs[0])
    material, tree, output = node_material(name)
    outer, reroute = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("NodeReroute")
    outer.node_tree = group
    tree.links.new(outer.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], output.inputs["Surface"])
    return material


def volume_only(name: str) -> bpy.types.Material:
    material, tree, output = node_material(name)
    tree.links.new(tree.nodes.new("ShaderNodeVolumeScatter").outputs[0], output.inputs["Volume"])
    return material


def strip(materials, indices=None) -> bpy.types.Object:
    """One quad per entry of `indices` (slot of the quad), with the materials in the slots."""
    indices = list(range(len(materials))) if indices is None else indices
    vertices = [(x + dx, dy, 0) for x in range(len(indices)) for dx, dy in ((0, 0), (0.9, 0), (0.9, 0.9), (0, 0.9))]
    mesh = make_mesh("Strip", vertices, [(4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3) for i in range(len(indices))])
    for material in materials:
        mesh.materials.append(material)
    for polygon, index in zip(mesh.polygons, indices, strict=True):
        polygon.material_index = index
    return add_object("Strip", mesh)


def quads_left(snapshot) -> list[int]:
    if not snapshot.meshes:
        return []
    mesh = snapshot.meshes[0]
    return sorted({int(mesh.positions[v, 0]) for v in mesh.triangles.ravel()})


def test_which_materials_vanish(scene):
    strip(
        [
            principled("opaque"),
            principled("alpha 0", 0.0),
            transparent("clear"),
            None,
            transparent("black filter", (0, 0, 0, 1)),
            mixed("mix 0", 0.0),
            mixed("mix 1", 1.0),
            grouped("group"),
            volume_only("fog"),
        ]
    )
    snapshot = exported()
    assert quads_left(snapshot) == [0, 3, 4, 6]
    assert not [text for text in snapshot.warnings if "transparency" in text]


def test_partial_and_textured_transparency_is_opaque_and_named_once(scene):
    leaf = principled("Leaf", textured=True)
    strip([leaf, principled("Half", 0.5), transparent("Red filter", (1, 0, 0, 1)), mixed("Veil", 0.5)])
    strip([leaf])
    snapshot = exported()
    assert quads_left(snapshot) == [0, 1, 2, 3]
    named = [text for text in snapshot.warnings if "transparency" in text]
    assert len(named) == 1
    for name in ("Leaf", "Half", "Red filter", "Veil"):
        assert named[0].count(f'"{name}"') == 1


def test_an_object_of_nothing_but_transparency_is_no_instance(scene):
    strip([transparent("clear")])
    assert exported().instance_count == 0


def test_indices_beyond_the_slots_take_the_last_slot(scene):
    strip([principled("opaque"), transparent("clear")], [0, 1, 5])
    assert quads_left(exported()) == [0]
    bpy.data.objects["Strip"].data.materials.clear()
    assert quads_left(exported()) == [0, 1, 2]


def test_object_linked_slots_split_a_shared_mesh(scene):
    first = strip([principled("opaque"), principled("second")])
    second = add_object("Other", first.data)
    second.material_slots[1].link = "OBJECT"
    second.material_slots[1].material = transparent("clear")
    snapshot = exported()
    counts = [len(snapshot.meshes[index].triangles) for index in snapshot.instance_mesh]
    assert dict(zip(snapshot.instance_names, counts, strict=True)) == {"Strip": 4, "Other": 2}


@pytest.mark.parametrize(("override", "left"), [("solid", [0, 1]), ("clear", [])])
def test_material_override_of_the_view_layer_replaces_all(scene, override, left):
    strip([principled("opaque"), transparent("clear too")])
    made = principled("solid") if override == "solid" else transparent("clear")
    bpy.context.view_layer.material_override = made
    assert quads_left(exported()) == left


def test_lights_without_layers_are_named(scene):
    material, tree, output = node_material("Glow")
    tree.links.new(tree.nodes.new("ShaderNodeEmission").outputs[0], output.inputs["Surface"])
    strip([material])
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    background = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.1, 0.2, 0.3, 1)
    text = "\n".join(exported().warnings)
    assert 'light of emissive meshes has no layer: "Strip"' in text
    assert 'light of the world "Sky" has no layer' in text
    background.inputs["Strength"].default_value = 0
    assert "Sky" not in "\n".join(exported().warnings)
