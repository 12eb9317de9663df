# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What changes Cycles' shadows and is not followed is named once; what doesn't change them is not."""

import math

import bpy
import pytest
from addon_helpers import add_camera, add_light, add_object, cube_mesh, exported


@pytest.fixture
def scene(fresh_scene):
    add_camera()
    add_object("Cube", cube_mesh())
    fresh_scene.shadow_layers.techniques = {"soft"}
    return fresh_scene


def add_gobo(lamp: bpy.types.Object) -> None:
    data = lamp.data
    data.use_nodes = True
    tree = data.node_tree
    texture = tree.nodes.new("ShaderNodeTexChecker")
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(texture.outputs["Color"], emission.inputs["Color"])


def uneven(kind: str, change: str, size: float) -> bpy.types.Object:
    lamp = add_light(kind, "Key")
    if kind in {"SPOT", "POINT"}:
        lamp.data.shadow_soft_size = size
    if kind == "SPOT":
        lamp.data.spot_blend = 0.0
    if kind == "SUN":
        lamp.data.angle = size
    if change == "nodes":
        add_gobo(lamp)
    elif change == "plain nodes":
        lamp.data.use_nodes = True
    elif change == "spread":
        lamp.data.spread = math.radians(20)
    elif change == "blend":
        lamp.data.spot_blend = 0.5
    return lamp


@pytest.mark.parametrize(
    ("kind", "change", "size", "text"),
    [
        ("AREA", "nodes", 1, "nodes and textures"),
        ("POINT", "nodes", 0.5, "nodes and textures"),
        ("SUN", "nodes", 0.1, "nodes and textures"),
        ("POINT", "nodes", 0, None),
        ("AREA", "plain nodes", 1, None),
        ("AREA", "spread", 1, "spread of area lights"),
        ("AREA", "", 1, None),
        ("SPOT", "blend", 0.5, "blend of spot lights"),
        ("SPOT", "blend", 0, None),
        ("SPOT", "", 0.5, None),
    ],
)
def test_lights_whose_points_are_uneven(scene, kind, change, size, text):
    uneven(kind, change, size)
    warnings = exported().warnings
    if text is None:
        assert not warnings
    else:
        assert len(warnings) == 1 and text in warnings[0] and '"Key"' in warnings[0]
    scene.shadow_layers.techniques = {"exact"}  # which takes every light as a point
    assert not exported().warnings


@pytest.mark.parametrize(("method", "named"), [("BUMP", False), ("DISPLACEMENT", True), ("BOTH", True)])
def test_true_displacement(scene, method, named):
    add_light("SUN")
    material = bpy.data.materials.new("Rough")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = method
    nodes = material.node_tree.nodes
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    material.node_tree.links.new(nodes.new("ShaderNodeDisplacement").outputs[0], output.inputs["Displacement"])
    bpy.data.objects["Cube"].data.materials.append(material)
    warnings = exported().warnings
    assert [("displacement" in w, '"Rough"' in w) for w in warnings] == ([(True, True)] if named else [])


def test_simplify_limits_subdivision_as_in_cycles(scene):
    add_light("SUN")
    modifier = bpy.data.objects["Cube"].modifiers.new("Subdivision", "SUBSURF")
    modifier.render_levels = 3
    assert exported().triangle_count == 6 * 4**3 * 2
    scene.render.use_simplify = True
    scene.render.simplify_subdivision_render = 1
    scene.render.simplify_subdivision = 0
    assert exported().triangle_count == 6 * 4 * 2
    assert not exported().warnings


def test_simplify_limits_child_particles_as_in_cycles(scene):
    add_light("SUN")
    ground = bpy.data.objects["Cube"]
    leaf = add_object("Leaf", cube_mesh(0.1))
    leaf.hide_render = False
    ground.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = ground.particle_systems[0].settings
    settings.type, settings.use_advanced_hair = "HAIR", True
    settings.count, settings.render_type, settings.instance_object = 10, "OBJECT", leaf
    settings.child_type = "SIMPLE"
    settings.rendered_child_count = 8
    many = exported().instance_count
    assert many >= 80
    scene.render.use_simplify = True
    scene.render.simplify_child_particles_render = 0.25
    assert exported().instance_count - 2 == pytest.approx((many - 2) / 4, rel=0.1)


def test_culling_by_simplify_is_named(scene):
    add_light("SUN")
    bpy.data.objects["Cube"].cycles.use_distance_cull = True
    scene.cycles.use_distance_cull = True
    assert not exported().warnings
    scene.render.use_simplify = True
    assert [("culling" in w, '"Cube"' in w) for w in exported().warnings] == [(True, True)]


def test_adaptive_subdivision_is_named(scene):
    add_light("SUN")
    cube = bpy.data.objects["Cube"]
    modifier = cube.modifiers.new("Subdivision", "SUBSURF")
    if hasattr(modifier, "use_adaptive_subdivision"):
        modifier.use_adaptive_subdivision = True
    else:
        scene.cycles.feature_set = "EXPERIMENTAL"
        cube.cycles.use_adaptive_subdivision = True
    assert [("adaptive" in w, '"Cube"' in w) for w in exported().warnings] == [(True, True)]
