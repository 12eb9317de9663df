# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is being edited while it is rendered: every mode delivers what Cycles renders at that moment."""

import json

import bmesh
import bpy
import numpy as np
import pytest
from addon_helpers import add_camera, add_light, add_object, cube_mesh, exported, world_triangles
from test_export_materials import transparent


@pytest.fixture
def scene(fresh_scene):
    add_camera()
    add_light("SUN")
    return fresh_scene


def enter(item: bpy.types.Object, mode: str) -> None:
    for other in bpy.context.view_layer.objects:
        other.select_set(False)
    bpy.context.view_layer.objects.active = item
    item.select_set(True)
    bpy.ops.object.mode_set(mode=mode)
    assert item.mode == mode


def stretch_in_edit_mode(item: bpy.types.Object, factor: float = 3.0) -> None:
    """An edit that isn't written back to the mesh yet."""
    edited = bmesh.from_edit_mesh(item.data)
    for vertex in edited.verts:
        vertex.co.z *= factor
    bmesh.update_edit_mesh(item.data)


def top(snapshot) -> float:
    return float(world_triangles(snapshot)[..., 2].max())


@pytest.mark.parametrize("modifier", [None, "ARMATURE", "SIMPLE_DEFORM", "ARRAY", "SUBSURF", "MASK"])
def test_object_in_edit_mode_is_exported_with_its_unsaved_edits(scene, modifier):
    item = add_object("Edited", cube_mesh())
    if modifier:
        made = item.modifiers.new("Modifier", modifier)
        if modifier == "SUBSURF":
            made.subdivision_type = "SIMPLE"
            made.render_levels = 2
    enter(item, "EDIT")
    stretch_in_edit_mode(item)
    snapshot = exported()
    assert snapshot.triangle_count == {"ARRAY": 24, "SUBSURF": 6 * 16 * 2, "MASK": 12}.get(modifier, 12)
    if modifier != "SIMPLE_DEFORM":
        assert top(snapshot) == pytest.approx(3.0)
    else:
        assert top(snapshot) > 3.0  # twisted after the edit


def test_edited_mesh_is_exported_for_all_its_users(scene):
    item = add_object("Edited", cube_mesh())
    add_object("Other", item.data, (5, 0, 0))
    enter(item, "EDIT")
    snapshot = exported()
    assert sorted(snapshot.instance_names) == ["Edited", "Other"]
    assert snapshot.triangle_count == 24


def test_edited_mesh_is_exported_where_it_is_instanced(scene):
    collection = bpy.data.collections.new("Inner")
    scene.collection.children.link(collection)
    item = add_object("Edited", cube_mesh(), collection=collection)
    empty = add_object("Empty", None, (5, 0, 0))
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    enter(item, "EDIT")
    stretch_in_edit_mode(item)
    snapshot = exported()
    triangles = world_triangles(snapshot)
    assert len(triangles) == 24
    assert triangles[..., 0].max() == pytest.approx(6.0)
    assert triangles[triangles[..., 0].min(axis=1) > 3][..., 2].max() == pytest.approx(3.0)


def test_several_objects_in_edit_mode(scene):
    for x in range(3):
        item = add_object(f"Edited{x}", cube_mesh(), (4 * x, 0, 0))
        item.select_set(True)
    bpy.context.view_layer.objects.active = item
    bpy.ops.object.mode_set(mode="EDIT")
    assert exported().triangle_count == 36


def test_transparent_faces_of_an_edited_mesh_are_left_out(scene):
    item = add_object("Edited", cube_mesh())
    clear, solid = transparent("Clear"), bpy.data.materials.new("Solid")
    item.data.materials.append(solid)
    item.data.materials.append(clear)
    for face in item.data.polygons[:4]:
        face.material_index = 1
    item.data.polygons[0].material_index = 7  # beyond the last slot: takes the last
    enter(item, "EDIT")
    assert exported().triangle_count == 4


def test_edits_go_on_between_renders(scene):
    item = add_object("Edited", cube_mesh())
    enter(item, "EDIT")
    for expected in (2.0, 4.0):
        stretch_in_edit_mode(item, 2.0)
        assert top(exported()) == pytest.approx(expected)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert top(exported()) == pytest.approx(4.0)


@pytest.mark.parametrize("mode", ["SCULPT", "WEIGHT_PAINT", "VERTEX_PAINT", "TEXTURE_PAINT"])
def test_painting_and_sculpting_keep_the_object(scene, mode):
    item = add_object("Painted", cube_mesh())
    enter(item, mode)
    assert exported().triangle_count == 12


def test_dynamic_topology_keeps_the_object(scene):
    item = add_object("Sculpted", cube_mesh())
    enter(item, "SCULPT")
    bpy.ops.sculpt.dynamic_topology_toggle()
    assert item.use_dynamic_topology_sculpting
    assert exported().triangle_count == 12


def test_pose_mode_keeps_the_deformed_object(scene):
    armature = bpy.data.armatures.new("Rig")
    rig = add_object("Rig", armature)
    enter(rig, "EDIT")
    bone = armature.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, -1), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    item = add_object("Posed", cube_mesh())
    group = item.vertex_groups.new(name="Bone")
    group.add(range(8), 1.0, "REPLACE")
    item.modifiers.new("Armature", "ARMATURE").object = rig
    enter(rig, "POSE")
    rig.pose.bones["Bone"].location = (0, 2.0, 0)  # along the bone: up
    assert top(exported()) == pytest.approx(3.0)


@pytest.mark.parametrize("build", ["curve", "text"])
def test_edited_curves_and_texts_come_once(scene, build):
    if build == "curve":
        bpy.ops.curve.primitive_bezier_circle_add()
        bpy.context.object.data.bevel_depth = 0.2
    else:
        bpy.ops.object.text_add()
        bpy.context.object.data.extrude = 0.1
    before = exported()
    enter(bpy.context.object, "EDIT")
    after = exported()
    assert len(after.instance_names) == 1
    assert np.array_equal(world_triangles(after), world_triangles(before))


def test_file_saved_in_edit_mode_renders_whole_in_the_batch(scene, run_batch, tmp_path):
    item = add_object("Edited", cube_mesh())
    enter(item, "EDIT")
    stretch_in_edit_mode(item)
    path = tmp_path / "edited.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    out = tmp_path / "out"
    done = run_batch(path, "render", "--techniques", "exact", "--resolution", "32x32", "--out", out)
    assert done.returncode == 0, done.stdout + done.stderr
    document = json.loads((out / "render.json").read_text())
    assert document["frames"][0]["triangles"] == 12
