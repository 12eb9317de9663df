# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry of the export against Blender's own evaluated data."""

import bpy
import numpy as np
import pytest
from addon_helpers import (
    add_camera,
    add_light,
    add_object,
    cube_mesh,
    exported,
    make_mesh,
    plane_mesh,
    render,
    sort_triangles,
    world_triangles,
)


@pytest.fixture
def scene(fresh_scene):
    add_camera()
    add_light("SUN")
    return fresh_scene


def blender_triangles() -> np.ndarray:
    """World triangles of everything visible, vertex by vertex from Blender: an independent way to the same data."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    parts = [np.zeros((0, 3, 3))]
    for instance in depsgraph.object_instances:
        item = instance.object
        if not instance.show_self or item.type != "MESH":
            continue
        if not instance.is_instance and item.parent and item.parent.instance_type in {"VERTS", "FACES"}:
            continue  # Blender hides the original of such instances in renders, but not here
        matrix, mesh = instance.matrix_world.copy(), item.data
        mesh.calc_loop_triangles()
        corners = [[matrix @ mesh.vertices[v].co for v in triangle.vertices] for triangle in mesh.loop_triangles]
        if corners:
            parts.append(np.array(corners, np.float64).reshape(-1, 3, 3))
    return sort_triangles(np.concatenate(parts))


def build_text():
    curve = bpy.data.curves.new("Text", "FONT")
    curve.body = "Ab"
    curve.extrude = 0.1
    add_object("Text", curve)


def build_curve():
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = 0.2
    spline = curve.splines.new("POLY")
    spline.points.add(3)
    for index, point in enumerate(spline.points):
        point.co = (index, index % 2, 0, 1)
    add_object("Curve", curve)


def build_surface():
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()


def build_metaballs():
    for x in (0, 1.2):
        ball = bpy.data.metaballs.new("Ball")
        ball.elements.new()
        ball.render_resolution = ball.resolution = 0.3
        add_object("Ball", ball, (x, 0, 0))


def build_array_modifier():
    item = add_object("Cube", cube_mesh())
    modifier = item.modifiers.new("Array", "ARRAY")
    modifier.count = 4
    item.rotation_euler = (0.3, 0.2, 0.1)
    item.scale = (1, 2, -0.5)


def build_sheared_child():
    parent = add_object("Parent", None)
    parent.scale = (1, 3, 1)
    child = add_object("Child", cube_mesh())
    child.parent = parent
    child.rotation_euler = (0.4, 0.5, 0.6)


def build_collection_instances():
    collection = bpy.data.collections.new("Inner")
    add_object("A", cube_mesh(), (1, 0, 0), collection)
    add_object("B", plane_mesh(), (0, 1, 0), collection)
    for x in range(3):
        empty = add_object(f"Empty{x}", None, (x * 4, 0, 0))
        empty.instance_type = "COLLECTION"
        empty.instance_collection = collection
        empty.rotation_euler.z = x


def build_vertex_instances():
    child = add_object("Child", cube_mesh(0.1))
    parent = add_object("Parent", make_mesh("grid", [(x, y, 0) for x in range(5) for y in range(5)], []))
    child.parent = parent
    parent.instance_type = "VERTS"


def build_particles():
    ground = add_object("Ground", plane_mesh(10))
    child = add_object("Child", cube_mesh(0.2))
    ground.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = ground.particle_systems[0].settings
    settings.count = 20
    settings.frame_start = settings.frame_end = 1
    settings.render_type = "OBJECT"
    settings.instance_object = child
    settings.particle_size = 1


def build_geometry_nodes():
    host = add_object("Host", make_mesh("points", [(0, 0, 0), (3, 0, 0), (0, 3, 0)], []))
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    place, cube = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeMeshCube")
    join = tree.nodes.new("GeometryNodeJoinGeometry")
    tree.links.new(start.outputs[0], place.inputs["Points"])
    tree.links.new(cube.outputs[0], place.inputs["Instance"])
    tree.links.new(place.outputs[0], join.inputs[0])
    tree.links.new(join.outputs[0], end.inputs[0])
    host.modifiers.new("Nodes", "NODES").node_group = tree


def build_shape_key():
    item = add_object("Cube", cube_mesh())
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Tall")
    for point in key.data:
        point.co.z *= 3
    key.value = 0.5


def build_armature():
    item = add_object("Cube", cube_mesh())
    rig = add_object("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    item.modifiers.new("Armature", "ARMATURE").object = rig
    item.vertex_groups.new(name="Bone").add(range(8), 1.0, "REPLACE")
    rig.pose.bones["Bone"].location = (1, 2, 3)


BUILDERS = [value for name, value in list(globals().items()) if name.startswith("build_")]


@pytest.mark.parametrize("build", BUILDERS, ids=lambda build: build.__name__[6:])
def test_world_triangles_are_blenders(scene, build):
    build()
    bpy.context.view_layer.update()
    expected = blender_triangles()
    snapshot = exported()
    assert len(expected) > 0
    found = world_triangles(snapshot)
    assert found.shape == expected.shape
    np.testing.assert_allclose(found, expected, atol=2e-5)


def test_instances_share_one_mesh(scene):
    build_vertex_instances()
    build_collection_instances()
    snapshot = exported()
    meshes = {mesh.name for mesh in snapshot.meshes}
    assert len(snapshot.meshes) == len(meshes) == 3  # the small cube, A and B
    assert snapshot.instance_count == 25 + 6


def test_render_level_of_modifiers_counts(scene):
    item = add_object("Cube", cube_mesh())
    modifier = item.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 0, 2
    assert exported().triangle_count == 6 * 16 * 2


def test_render_visibility_counts_and_viewport_visibility_does_not(scene):
    shown = add_object("viewport hidden", plane_mesh(name="viewport hidden"))
    shown.hide_viewport = True
    hidden = add_object("render hidden", plane_mesh(name="render hidden"))
    hidden.hide_render = True
    h = add_object("eye closed", plane_mesh(name="eye closed"))
    h.hide_set(True)
    for name, attribute in (("excluded", None), ("collection hidden", "hide_render")):
        collection = bpy.data.collections.new(name)
        scene.collection.children.link(collection)
        add_object(name, plane_mesh(name=name), collection=collection)
        if attribute:
            setattr(collection, attribute, True)
        else:
            bpy.context.view_layer.layer_collection.children[name].exclude = True
    assert sorted(exported().instance_names) == ["eye closed", "viewport hidden"]


def flags_of(snapshot) -> dict[str, int]:
    return dict(zip(snapshot.instance_names, snapshot.instance_flags.tolist(), strict=True))


def test_ray_visibility_becomes_flags(scene):
    for camera in (True, False):
        for shadow in (True, False):
            item = add_object(f"c{camera:d}s{shadow:d}", plane_mesh())
            item.visible_camera, item.visible_shadow = camera, shadow
    assert flags_of(exported()) == {"c1s1": 3, "c1s0": 1, "c0s1": 2}


def test_instancer_takes_visibility_away_and_never_gives_it(scene):
    collection = bpy.data.collections.new("Inner")
    for name, shadow in (("casts", True), ("casts not", False)):
        add_object(name, plane_mesh(), collection=collection).visible_shadow = shadow
    found = {}
    for name, shadow in (("on", True), ("off", False)):
        empty = add_object(name, None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.visible_shadow = shadow
    snapshot = exported()
    for name, flags in zip(snapshot.instance_names, snapshot.instance_flags.tolist(), strict=True):
        found.setdefault(name, []).append(flags)
    assert {name: sorted(flags) for name, flags in found.items()} == {"casts": [1, 3], "casts not": [1, 1]}


def test_holdouts_of_objects_and_collections(scene):
    add_object("hole", plane_mesh()).is_holdout = True
    collection = bpy.data.collections.new("Holes")
    scene.collection.children.link(collection)
    add_object("hole by collection", plane_mesh(), collection=collection)
    bpy.context.view_layer.layer_collection.children["Holes"].holdout = True
    add_object("plain", plane_mesh())
    assert flags_of(exported()) == {"hole": 7, "hole by collection": 7, "plain": 3}


def test_indirect_only_objects_cast_and_are_not_seen(scene):
    collection = bpy.data.collections.new("Indirect")
    scene.collection.children.link(collection)
    add_object("unseen", plane_mesh(), collection=collection)
    bpy.context.view_layer.layer_collection.children["Indirect"].indirect_only = True
    assert flags_of(exported()) == {"unseen": 2}


def test_unsupported_kinds_are_named_and_skipped(scene):
    add_object("Smoke", bpy.data.volumes.new("Smoke"))
    if hasattr(bpy.data, "hair_curves"):
        add_object("Fur", bpy.data.hair_curves.new("Fur"))
    ground = add_object("Ground", plane_mesh())
    ground.modifiers.new("Hair", "PARTICLE_SYSTEM")
    ground.particle_systems[0].settings.type = "HAIR"
    snapshot = exported()
    assert snapshot.instance_names == ["Ground"]
    text = "\n".join(snapshot.warnings)
    assert 'volumes are not supported and left out: "Smoke"' in text
    assert "particle hair is not supported and left out" in text
    if hasattr(bpy.data, "hair_curves"):
        assert 'hair curves are not supported and left out: "Fur"' in text


def test_empty_meshes_and_edges_alone_are_no_instances(scene):
    add_object("empty", bpy.data.meshes.new("empty"))
    edge = bpy.data.meshes.new("edge")
    edge.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    add_object("edge", edge)
    add_object("Plane", plane_mesh())
    snapshot = exported()
    assert snapshot.instance_names == ["Plane"]
    assert len(snapshot.meshes) == 1


def test_unchanged_arrays_are_kept_and_deformed_ones_read_again(scene):
    build_shape_key()
    add_object("Still", plane_mesh(name="Still"))
    first = exported()
    bpy.data.objects["Cube"].data.shape_keys.key_blocks["Tall"].value = 1.0
    second = exported()
    by_name = [{mesh.name: mesh for mesh in snapshot.meshes} for snapshot in (first, second)]
    assert by_name[0]["Still"].positions is by_name[1]["Still"].positions
    assert by_name[0]["Cube"].triangles is by_name[1]["Cube"].triangles
    assert by_name[0]["Cube"].positions is not by_name[1]["Cube"].positions
    assert by_name[1]["Cube"].positions[:, 2].max() == pytest.approx(3)


def test_each_view_layer_exports_its_own_collections(scene):
    collection = bpy.data.collections.new("Extra")
    scene.collection.children.link(collection)
    add_object("extra", plane_mesh(), collection=collection)
    add_object("common", plane_mesh())
    scene.view_layers.new("Second").layer_collection.children["Extra"].exclude = True
    captured = render()
    names = {frame.view_layer: sorted(frame.snapshot.instance_names) for frame in captured.frames}
    assert names == {scene.view_layers[0].name: ["common", "extra"], "Second": ["common"]}


def test_many_triangles_keep_their_winding_and_count(scene):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=300, y_subdivisions=300, size=10)
    snapshot = exported()
    assert snapshot.triangle_count == 300 * 300 * 2
    corners = snapshot.meshes[0].positions[snapshot.meshes[0].triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert normal[:, 2].min() > 0
    assert normal[:, 2].sum() / 2 == pytest.approx(100, rel=1e-4)
