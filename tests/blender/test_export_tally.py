# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the depsgraph holds against what the export delivers: nothing is lost without a word."""

import json

import bpy
import pytest
from addon_helpers import add_camera, add_light, add_object, cube_mesh, exported, plane_mesh, render
from test_export_materials import transparent


@pytest.fixture
def scene(fresh_scene):
    add_camera()
    add_light("SUN")
    return fresh_scene


def add_nodes(item: bpy.types.Object, *names: str, join: bool = False) -> list[bpy.types.Node]:
    """A modifier of geometry nodes: the object's geometry through these nodes in a row, joined with itself if so."""
    group = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    if hasattr(group, "interface"):
        for way in ("INPUT", "OUTPUT"):
            group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    else:
        group.inputs.new("NodeSocketGeometry", "Geometry")
        group.outputs.new("NodeSocketGeometry", "Geometry")
    first, last = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    made = [group.nodes.new(f"GeometryNode{name}") for name in names]
    socket = first.outputs[0]
    for node in made:
        group.links.new(socket, node.inputs[0])
        socket = node.outputs[0]
    if join:
        both = group.nodes.new("GeometryNodeJoinGeometry")
        group.links.new(socket, both.inputs[0])
        group.links.new(first.outputs[0], both.inputs[0])
        socket = both.outputs[0]
    group.links.new(socket, last.inputs[0])
    item.modifiers.new("Nodes", "NODES").node_group = group
    return made


def losses(snapshot) -> dict[str, dict]:
    return {loss["reason"]: loss for loss in snapshot.contents["losses"]}


def expect_named(snapshot, text: str, name: str) -> dict:
    """One loss whose reason has that text, which names the object and stands in the warnings once."""
    found = [loss for reason, loss in losses(snapshot).items() if text in reason]
    assert len(found) == 1, snapshot.contents
    assert name in " ".join(found[0]["names"])
    assert sum(found[0]["reason"] in warning for warning in snapshot.warnings) == 1, snapshot.warnings
    return found[0]


def add_volume():
    add_object("Smoke", bpy.data.volumes.new("Smoke"))


def add_grease_pencil():
    owner = bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils
    add_object("Pencil", owner.new("Pencil"))


def add_hair_curves():
    add_object("Curves", bpy.data.hair_curves.new("Curves"))


def add_point_cloud():
    add_nodes(add_object("Dots", cube_mesh()), "MeshToPoints")


def add_mesh_and_point_cloud():
    add_nodes(add_object("Dots", cube_mesh()), "MeshToPoints", join=True)


def add_volume_by_nodes():
    add_nodes(add_object("Fog", cube_mesh()), "MeshToVolume")


def add_particle_hair():
    head = add_object("Head", plane_mesh())
    head.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = head.particle_systems[0].settings
    settings.type, settings.count = "HAIR", 10


@pytest.mark.parametrize(
    ("add", "text", "name", "triangles"),
    [
        (add_volume, "volumes", "Smoke", 0),
        (add_grease_pencil, "grease pencil", "Pencil", 0),
        (add_hair_curves, "hair curves", "Curves", 0),
        (add_point_cloud, "point clouds", "Dots", 0),
        (add_mesh_and_point_cloud, "point clouds", "Dots", 12),
        (add_volume_by_nodes, "volumes", "Fog", 0),
        (add_particle_hair, "particle hair", "Head", 2),
    ],
)
def test_what_is_left_out_is_named_and_counted(scene, add, text, name, triangles):
    add()
    snapshot = exported()
    loss = expect_named(snapshot, text, name)
    assert loss["expected"] and loss["objects"] == loss["instances"] == 1
    assert snapshot.triangle_count == snapshot.contents["delivered"]["triangles"] == triangles


def add_text():
    curve = bpy.data.curves.new("Text", "FONT")
    curve.body, curve.extrude = "Ab", 0.1
    add_object("Text", curve)


def add_thin_curve():
    curve = bpy.data.curves.new("Thin", "CURVE")
    curve.splines.new("POLY").points.add(3)
    add_object("Thin", curve)


def add_curve_to_mesh():
    curve = bpy.data.curves.new("Tube", "CURVE")
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co = (0, 0, 3, 1)
    to_mesh = add_nodes(add_object("Tube", curve), "CurveToMesh")[0]
    group = to_mesh.id_data
    circle = group.nodes.new("GeometryNodeCurvePrimitiveCircle")
    group.links.new(circle.outputs[0], to_mesh.inputs["Profile Curve"])


def add_metaballs():
    for x in (0, 1):
        ball = bpy.data.metaballs.new("Ball")
        ball.elements.new()
        add_object("Ball", ball, (x, 0, 0))


def add_instances():
    collection = bpy.data.collections.new("Inner")
    add_object("Cube", cube_mesh(), collection=collection)
    for x in range(3):
        empty = add_object(f"Empty{x}", None, (4 * x, 0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection


def add_instanced_text():
    collection = bpy.data.collections.new("Inner")
    curve = bpy.data.curves.new("Text", "FONT")
    curve.body, curve.extrude = "Ab", 0.1
    add_object("Text", curve, collection=collection)
    empty = add_object("Empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection


def add_node_instances():
    group = add_nodes(add_object("Points", cube_mesh()), "MeshToPoints", "InstanceOnPoints")[1].id_data
    on_points = group.nodes["Instance on Points"]
    cube = group.nodes.new("GeometryNodeMeshCube")
    group.links.new(cube.outputs[0], on_points.inputs["Instance"])


def add_empty_meshes():
    add_object("Nothing", bpy.data.meshes.new("Nothing"))
    wires = bpy.data.meshes.new("Wires")
    wires.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    add_object("Wires", wires)
    masked = add_object("Masked", cube_mesh())
    masked.vertex_groups.new(name="None")
    masked.modifiers.new("Mask", "MASK").vertex_group = "None"


def add_hidden_objects():
    add_object("Off", cube_mesh()).hide_render = True
    no_rays = add_object("No rays", cube_mesh())
    no_rays.visible_camera = no_rays.visible_shadow = False


def add_holdout_and_catcher():
    add_object("Hole", cube_mesh()).is_holdout = True
    add_object("Catcher", cube_mesh()).is_shadow_catcher = True


def add_edited():
    item = add_object("Edited", cube_mesh())
    bpy.context.view_layer.objects.active = item
    bpy.ops.object.mode_set(mode="EDIT")


def add_shapeless():
    for name, data in (
        ("Lattice", bpy.data.lattices.new("Lattice")),
        ("Rig", bpy.data.armatures.new("Rig")),
        ("Speaker", bpy.data.speakers.new("Speaker")),
        ("Empty", None),
    ):
        add_object(name, data)
    add_light("AREA", name="Portal").data.cycles.is_portal = True


def add_half_transparent():
    item = add_object("Half", cube_mesh())
    item.data.materials.append(None)
    item.data.materials.append(transparent("Clear"))
    item.data.polygons[0].material_index = 1
    whole = add_object("Whole", cube_mesh())
    whole.data.materials.append(bpy.data.materials["Clear"])


@pytest.mark.parametrize(
    ("add", "instances", "triangles"),
    [
        (add_text, 1, None),
        (add_thin_curve, 0, 0),
        (add_curve_to_mesh, 1, 64),
        (add_metaballs, 1, None),
        (add_instances, 3, 36),
        (add_instanced_text, 1, None),
        (add_node_instances, 8, 96),
        (add_empty_meshes, 0, 0),
        (add_hidden_objects, 0, 0),
        (add_holdout_and_catcher, 2, 24),
        (add_edited, 1, 12),
        (add_shapeless, 0, 0),
        (add_half_transparent, 1, 10),
    ],
)
def test_nothing_is_lost(scene, add, instances, triangles):
    add()
    snapshot = exported()
    contents = snapshot.contents
    assert contents["losses"] == [], contents
    assert contents["delivered"]["instances"] == snapshot.instance_count == instances
    assert contents["delivered"]["triangles"] == snapshot.triangle_count
    assert snapshot.triangle_count == triangles or (triangles is None and snapshot.triangle_count > 100)
    assert not snapshot.warnings


def test_held_is_delivered_and_the_rest_has_a_fate(scene):
    add_instances()
    add_half_transparent()
    add_empty_meshes()
    contents = exported().contents
    assert contents["held"] == {"objects": 6, "instances": 8, "triangles": 36 + 12 + 12}
    assert contents["delivered"] == {"objects": 2, "instances": 4, "triangles": 36 + 10}
    assert contents["others"]["transparent"] == {"objects": 1, "instances": 1, "triangles": 12}
    assert contents["others"]["empty"]["objects"] == 3
    assert contents["by_kind"]["MESH"]["held"] == contents["held"]


def test_a_mesh_that_comes_out_empty_is_named(scene, module, monkeypatch):
    """The defect that hid edited objects, put back: reading finds no face."""
    add_object("Gone", cube_mesh())
    mesh_export = module("mesh_export")
    monkeypatch.setattr(mesh_export, "read_counted", lambda *_: mesh_export.ReadMesh())
    snapshot = exported()
    loss = expect_named(snapshot, "came out empty", "Gone")
    assert not loss["expected"]


def test_triangles_that_are_not_read_are_named(scene, module, monkeypatch):
    add_object("Torn", cube_mesh())
    mesh_export = module("mesh_export")
    read = mesh_export.read_mesh

    def read_less(*arguments):
        data = read(*arguments)
        data.triangles = data.triangles[:-2].copy()
        return data

    monkeypatch.setattr(mesh_export, "read_mesh", read_less)
    loss = expect_named(exported(), "not all triangles", "Torn")
    assert (loss["expected"], loss["triangles"]) == (False, 2)


def test_a_curve_whose_mesh_does_not_come_is_named(scene, module, monkeypatch):
    add_text()
    scene_export = module("scene_export")
    monkeypatch.setattr(scene_export._Walk, "_examine_mesh", lambda *_: None)
    tally = module("scene_tally")
    monkeypatch.setattr(
        tally.SceneTally, "find_unreplaced", lambda self: [e for e in self.entries if e.fate is tally.Fate.REPLACED]
    )
    loss = expect_named(exported(), "curves whose mesh did not come", "Text")
    assert not loss["expected"]


def test_viewport_counts_too(scene, module):
    add_object("Cube", cube_mesh())
    camera = exported().camera
    settings = exported().render
    exporter = module("scene_export").SceneExporter()
    snapshot = exporter.export(bpy.context.evaluated_depsgraph_get(), camera, settings)
    assert snapshot.contents["delivered"]["triangles"] == 12


def test_render_json_and_log_name_the_loss_once(scene, run_batch, tmp_path, capfd):
    add_object("Ground", plane_mesh(4))
    add_volume()
    for _ in range(2):
        captured = render()
    said = capfd.readouterr().out.splitlines()
    assert sum(line.startswith("Shadow Layers: volumes are not supported") for line in said) == 2  # one a render
    assert captured.frames[0].snapshot.contents["losses"]
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    out = tmp_path / "out"
    run_batch(path, "render", "--techniques", "exact", "--resolution", "32x18", "--out", out)
    frame = json.loads((out / "render.json").read_text())["frames"][0]
    assert frame["contents"]["losses"][0]["names"] == ["Smoke"]
    assert frame["contents"]["delivered"]["triangles"] == 2
    run_batch(
        path, "compare", "--techniques", "exact", "--resolution", "32x18", "--no-cache", "--out", out
    )
    comparison = json.loads((out / "comparison.json").read_text())
    assert comparison["frames"][0]["contents"]["losses"][0]["names"] == ["Smoke"]
    page = (out / "index.html").read_text()
    assert page.count("volumes are not supported and left out") == 1
