# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights, their linking and their jobs in the export."""

import bpy
import numpy as np
import pytest
from addon_helpers import add_camera, add_light, add_object, cube_mesh, exported, plane_mesh
from mathutils import Euler, Matrix, Vector

NEEDS_LINKING = pytest.mark.skipif(bpy.app.version < (4, 0), reason="light linking came with Blender 4.0")


@pytest.fixture
def scene(fresh_scene):
    add_camera()
    add_object("Ground", plane_mesh(10))
    return fresh_scene


def lights_by_name() -> dict:
    return {light.name: light for light in exported().lights}


def test_values_of_the_four_kinds(scene):
    add_light("SUN", energy=3, angle=0.1)
    add_light("SPOT", energy=100, spot_size=1.2, spot_blend=0.4, shadow_soft_size=0.3, color=(1, 0.5, 0.25))
    add_light("POINT", energy=50, shadow_soft_size=0.7)
    add_light("AREA", energy=10, shape="RECTANGLE", size=2, size_y=3)
    add_light("AREA", name="Disk", shape="DISK", size=2, size_y=3)
    lights = lights_by_name()
    assert lights["Sun"].sun_angle == pytest.approx(0.1)
    assert lights["Spot"].color == pytest.approx((1, 0.5, 0.25))
    assert (lights["Spot"].spot_angle, lights["Spot"].spot_blend) == pytest.approx((1.2, 0.4))
    assert (lights["Spot"].radius, lights["Point"].radius) == pytest.approx((0.3, 0.7))
    assert lights["Point"].energy == pytest.approx(50)
    assert lights["Area"].area_size == pytest.approx((2, 3))
    assert not lights["Area"].area_round
    assert lights["Disk"].area_size == pytest.approx((2, 2))
    assert lights["Disk"].area_round
    assert [light.kind for light in lights.values()] == ["SUN", "SPOT", "POINT", "AREA", "AREA"]


@pytest.mark.parametrize("scale", [(2, 3, 5), (-2, 3, 1), (1, 1, -4), (0, 0, 0), (1e-4, 1e5, 1)])
def test_scale_goes_into_the_area_and_leaves_the_axes_alone(scene, scale):
    lamp = add_light("AREA", shape="SQUARE", size=0.5, location=(1, 2, 3))
    lamp.rotation_euler = rotation = Euler((0.3, 0.5, 0.7))
    lamp.scale = scale
    light = lights_by_name()["Area"]
    axes = light.world_from_light[:3, :3]
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(light.world_from_light[:3, 3], (1, 2, 3), atol=1e-6)
    assert light.area_size == pytest.approx((0.5 * abs(scale[0]), 0.5 * abs(scale[1])), rel=1e-5)
    if scale[2] != 0:
        # Cycles takes the direction from the matrix's own third column, so a mirrored Z turns the light round.
        expected = rotation.to_matrix() @ Vector((0, 0, -1 if scale[2] > 0 else 1))
        np.testing.assert_allclose(-axes[:, 2], expected, atol=1e-6)


def test_shadow_switches(scene):
    add_light("SUN", name="on")
    add_light("SUN", name="off", use_shadow=False)
    lamp = add_light("SUN", name="off in Cycles")
    lights = lights_by_name()
    if hasattr(lamp.data.cycles, "cast_shadow"):
        lamp.data.cycles.cast_shadow = False
        assert not lights_by_name()["off in Cycles"].casts_shadow
    assert (lights["on"].casts_shadow, lights["off"].casts_shadow) == (True, False)


def test_portals_and_hidden_lights_are_no_lights(scene):
    add_light("SUN")
    add_light("AREA", name="Portal").data.cycles.is_portal = True
    add_light("POINT", name="Hidden").hide_render = True
    add_light("POINT", name="Eye closed").hide_set(True)
    snapshot = exported()
    assert [light.name for light in snapshot.lights] == ["Sun", "Eye closed"]


def test_instanced_lights_have_names_and_places_of_their_own(scene):
    collection = bpy.data.collections.new("Lamp")
    lamp = add_light("POINT", name="Bulb")
    scene.collection.objects.unlink(lamp)
    collection.objects.link(lamp)
    for x in range(3):
        empty = add_object(f"Post{x}", None, (x * 10, 0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
    lights = exported().lights
    assert [light.name for light in lights] == ["Bulb @Post0", "Bulb @Post1", "Bulb @Post2"]
    assert [light.world_from_light[0, 3] for light in lights] == pytest.approx([0, 10, 20])


def test_jobs_follow_scene_and_light_settings(scene):
    from addon import bridge

    settings = scene.shadow_layers
    settings.techniques = {"sm", "edsm"}
    settings.map_size = 256
    add_light("SUN", name="As scene")
    own = add_light("POINT", name="Own").data.shadow_layers
    own.mode, own.technique, own.map_size = "OVERRIDE", "pcf", 64
    add_light("SPOT", name="Off").data.shadow_layers.mode = "OFF"
    snapshot = exported()
    names = [light.name for light in snapshot.lights]
    jobs = [(names[job.light], job.technique, job.parameters["map_size"]) for job in snapshot.jobs]
    order = [info["id"] for info in bridge.techniques()]
    scene_jobs = sorted([("As scene", "sm", 256), ("As scene", "edsm", 256)], key=lambda job: order.index(job[1]))
    assert jobs == [*scene_jobs, ("Own", "pcf", 64)]
    assert "Off" in names  # its geometry facts stay in the snapshot, its layers don't
    for job in snapshot.jobs:
        assert bridge.resolve_parameters(job.technique, job.parameters).keys() == job.parameters.keys()


def test_keyed_settings_are_taken_at_their_frame(scene):
    lamp = add_light("SPOT", spot_size=1.0)
    for frame, value in ((1, 1.0), (11, 2.0)):
        lamp.data.spot_size = value
        lamp.data.keyframe_insert("spot_size", frame=frame)
    for frame, value in ((1, 1.0), (11, 2.0)):
        scene.frame_set(frame)
        assert exported().lights[0].spot_angle == pytest.approx(value)


# Linking: eight tiles in a row; Cycles itself says which of them a light reaches, and which lose their caster.

TILES = 8


def build_tiles(scene, lift: float = 0.0):
    tiles = [add_object(f"Tile{x}", plane_mesh(0.9, f"Tile{x}"), (x - 3.5, 0, lift)) for x in range(TILES)]
    camera = scene.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", TILES
    scene.render.resolution_x, scene.render.resolution_y = TILES * 4, 4
    bpy.data.objects.remove(bpy.data.objects["Ground"])
    return tiles


def cycles_lit(scene, tmp_path) -> list[bool]:
    """Which tiles a Cycles render sees lit (by any light)."""
    from addon_helpers import read_exr, set_multilayer_output

    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = 0
    scene.world = None
    path = tmp_path / "lit.exr"
    set_multilayer_output(path)
    bpy.ops.render.render(write_still=True)
    scene.render.engine = "SHADOW_LAYERS"
    pictures, _ = read_exr(path)
    combined = next(v for k, v in pictures.items() if k.endswith("Combined.R"))
    return [bool(combined[1:3, x * 4 + 1 : x * 4 + 3].mean() > 1e-3) for x in range(TILES)]


def link_states(collection, states: dict[str, str]):
    for item, link in zip(collection.objects, collection.collection_objects, strict=True):
        link.light_linking.link_state = states[item.name]


def receiver_case_include(lamp, tiles):
    links = bpy.data.collections.new("links")
    for tile in tiles[1:4]:
        links.objects.link(tile)
    return links


def receiver_case_exclude(lamp, tiles):
    links = receiver_case_include(lamp, tiles)
    link_states(links, dict.fromkeys(["Tile1", "Tile2", "Tile3"], "EXCLUDE"))
    return links


def receiver_case_mixed(lamp, tiles):
    links = receiver_case_include(lamp, tiles)
    link_states(links, {"Tile1": "INCLUDE", "Tile2": "EXCLUDE", "Tile3": "INCLUDE"})
    return links


def receiver_case_empty(lamp, tiles):
    return bpy.data.collections.new("links")


def receiver_case_child_collection(lamp, tiles):
    links, child = bpy.data.collections.new("links"), bpy.data.collections.new("child")
    grandchild = bpy.data.collections.new("grandchild")
    for tile in tiles[:4]:
        child.objects.link(tile)
    grandchild.objects.link(tiles[6])
    child.children.link(grandchild)
    links.children.link(child)
    links.collection_children[0].light_linking.link_state = "EXCLUDE"
    links.objects.link(tiles[2])  # named directly too: the direct state wins
    links.objects.link(tiles[5])
    return links


CASES = [value for name, value in list(globals().items()) if name.startswith("receiver_case_")]


@NEEDS_LINKING
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.__name__[14:])
def test_receivers_are_those_that_cycles_lights(scene, tmp_path, case):
    tiles = build_tiles(scene)
    add_light("SUN", name="Other", energy=0.0)  # not linked: its set must stay full
    lamp = add_light("SUN", name="Linked")
    lamp.light_linking.receiver_collection = case(lamp, tiles)
    second = add_light("SUN", name="Second", energy=0.0)
    second.light_linking.receiver_collection = bpy.data.collections.new("second")
    second.light_linking.receiver_collection.objects.link(tiles[3])
    bpy.context.view_layer.update()
    snapshot = exported()
    lights = {light.name: light for light in snapshot.lights}
    groups = dict(zip(snapshot.instance_names, snapshot.instance_receiver_group.tolist(), strict=True))
    ours = [bool(lights["Linked"].receiver_set >> groups[f"Tile{x}"] & 1) for x in range(TILES)]
    assert ours == cycles_lit(scene, tmp_path)
    assert all(lights["Other"].receiver_set >> group & 1 for group in groups.values())
    assert [x for x in range(TILES) if lights["Second"].receiver_set >> groups[f"Tile{x}"] & 1] == [3]


@NEEDS_LINKING
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.__name__[14:])
def test_blockers_are_those_that_cycles_lets_cast(scene, tmp_path, case):
    tiles = build_tiles(scene, lift=1.0)
    for tile in tiles:
        tile.visible_camera = False
    add_object("Ground", plane_mesh(20))
    lamp = add_light("SUN", name="Linked")
    lamp.light_linking.blocker_collection = case(lamp, tiles)
    snapshot = exported()
    groups = dict(zip(snapshot.instance_names, snapshot.instance_blocker_group.tolist(), strict=True))
    casts = [bool(snapshot.lights[0].blocker_set >> groups[f"Tile{x}"] & 1) for x in range(TILES)]
    assert casts == [not lit for lit in cycles_lit(scene, tmp_path)]


@NEEDS_LINKING
def test_linking_of_an_instancer_comes_before_that_of_its_objects(scene, tmp_path):
    tiles = build_tiles(scene)
    inner = bpy.data.collections.new("Inner")
    for tile in tiles:
        scene.collection.objects.unlink(tile)
    inner.objects.link(tiles[0])
    empties = []
    for x in range(TILES):
        empty = add_object(f"Empty{x}", None, (x, 0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", inner
        empties.append(empty)
    lamp = add_light("SUN", name="Linked")
    links = bpy.data.collections.new("links")
    for empty in empties[::3]:
        links.objects.link(empty)
    lamp.light_linking.receiver_collection = links
    snapshot = exported()
    order = np.argsort(snapshot.instance_matrix[:, 0, 3])
    groups = snapshot.instance_receiver_group[order].tolist()
    ours = [bool(snapshot.lights[0].receiver_set >> group & 1) for group in groups]
    assert ours == cycles_lit(scene, tmp_path)
    assert ours == [x % 3 == 0 for x in range(TILES)]


@NEEDS_LINKING
def test_more_groups_than_bits_are_named(scene):
    lamps = [add_light("POINT", name=f"Lamp{i}") for i in range(63)]
    cubes = [add_object(f"Cube{i}", cube_mesh()) for i in range(70)]
    for index, lamp in enumerate(lamps):
        lamp.light_linking.receiver_collection = links = bpy.data.collections.new(f"links{index}")
        links.objects.link(cubes[index])
        links.objects.link(cubes[(index + 7) % 70])
    snapshot = exported()
    assert any("more than 63 groups" in text for text in snapshot.warnings)
    assert snapshot.instance_receiver_group.max() <= 63


def test_a_sheared_light_stays_orthonormal(scene):
    parent = add_object("Parent", None)
    parent.scale = (1, 4, 1)
    lamp = add_light("SPOT")
    lamp.parent = parent
    lamp.matrix_parent_inverse = Matrix.Identity(4)
    lamp.rotation_euler = (0.5, 0.4, 0.3)
    axes = exported().lights[0].world_from_light[:3, :3]
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    expected = np.array(lamp.matrix_world.col[2][:3])
    np.testing.assert_allclose(axes[:, 2], expected / np.linalg.norm(expected), atol=1e-6)


@pytest.mark.parametrize("scale", [(1, 1, 1), (2, 2, 2), (1, 2, 1), (-3, 0.5, 2)])
def test_scale_of_a_spot_goes_into_its_cone(scene, scale):
    lamp = add_light("SPOT", spot_size=1.0)
    lamp.scale = scale
    light = lights_by_name()["Spot"]
    expected = (1, 1) if bpy.app.version < (4, 0) else (abs(scale[0] / scale[2]), abs(scale[1] / scale[2]))
    assert light.spot_scale == pytest.approx(expected, rel=1e-6)
    assert light.spot_angle == pytest.approx(1.0)
