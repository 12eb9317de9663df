# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shift, staircase and changes from frame to frame, by the batch's verb compare."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

LIGHTS = ("Sun", "Spot")


def add(name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    made.location, made.rotation_euler = location, rotation
    return made


@pytest.fixture(scope="module")
def blend(addon, tmp_path_factory):
    """A turned plate over a ground: four straight borders, along neither the picture's axes nor the maps'. The spot
    hangs on a moving arm, and turns towards a mark."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=14)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 1.5), rotation=(0, 0, 0.37))
    bpy.context.object.scale = (3.0, 2.2, 0.05)
    add("Sun", bpy.data.lights.new("Sun", "SUN"), (0, 0, 6), (0.2, 0.31, 0.2))
    arm = add("Arm", None)
    for frame, angle in ((1, 0.0), (11, 0.2)):
        arm.rotation_euler.z = angle
        arm.keyframe_insert("rotation_euler", frame=frame)
    mark = add("Mark", None, (0.2, 0.3, 0))
    light = bpy.data.lights.new("Spot", "SPOT")
    light.spot_size = math.radians(70)
    spot = add("Spot", light, (-1.1, -0.8, 6.5))
    spot.parent = arm
    track = spot.constraints.new("TRACK_TO")
    track.target, track.track_axis, track.up_axis = mark, "TRACK_NEGATIVE_Z", "UP_Y"
    camera = bpy.data.cameras.new("Camera")
    camera.angle = math.radians(40)
    scene.camera = add("Camera", camera, (0.5, -7.5, 8.5), (math.radians(40), 0, math.radians(4)))
    scene.render.engine = "SHADOW_LAYERS"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 240, 160, 100
    scene.frame_set(1)
    path = tmp_path_factory.mktemp("borders") / "plate.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_hard_map_has_the_staircase_of_its_texels(compare, tmp_path):
    """sm's border is off by what its texels are, whatever the light; edsm's has next to no staircase."""
    document = compare("--techniques", "sm,edsm", "--map-size", 128)
    records = {(record["light"], record["technique"]): record for record in document["records"]}
    for light in LIGHTS:
        sm, edsm = records[light, "sm"]["measures"], records[light, "edsm"]["measures"]
        assert sm["staircase_texels"] == pytest.approx(1 / math.sqrt(12), abs=0.08), light
        assert abs(sm["border_bias_texels"]) < 0.15, light
        assert edsm["staircase_texels"] < 0.25 * sm["staircase_texels"], light
        assert abs(edsm["border_bias_texels"]) < 0.03, light
        assert sm["unbiased_error_px"] > 3 * edsm["unbiased_error_px"], light
        border = records[light, "sm"]["border"]
        assert border["samples"] == 3 and border["compared_px"] > 150
        assert sm["unpaired_fraction"] < 0.05
    page = (tmp_path / "o" / "index.html").read_text()
    assert "Staircase (texels)" in page and "From frame to frame" not in page
    assert document["temporal"] == []


def test_large_pictures_get_fewer_samples(module):
    choose_samples = module("batch_border").choose_samples
    assert choose_samples(3, 1920, 1080) == 3 and choose_samples(16, 64, 64) == 16
    assert choose_samples(3, 2560, 1440) == 2 and choose_samples(3, 7680, 4320) == 1


def test_border_of_one_sample(compare):
    document = compare("--techniques", "sm", "--lights", "Sun", "--map-size", 128, "--border-samples", 1)
    record = document["records"][0]
    assert record["border"]["samples"] == 1
    assert record["measures"]["staircase_texels"] == pytest.approx(1 / math.sqrt(12), abs=0.12)


def test_pixels_reached_are_those_of_the_hard_truth(module, blend, tmp_path):
    """One render in place of two gives the same mask; from the cache too."""
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    scene = bpy.context.scene
    layer = scene.view_layers[0]
    with module("truth").CyclesTruth(scene, layer, 123, 77) as cycles:
        for name in LIGHTS:
            visible = cycles.render_light(name).visible
            assert np.array_equal(cycles.render_reached(name)[0], visible) and 0 < visible.mean() < 1
    scene.shadow_layers.techniques = {"sm"}
    captured = module("batch_render").render_frame(scene, 1)[0][0]
    masks = []
    for _ in range(2):
        with module("truth_store").TruthStore(scene, layer, captured.snapshot, folder=tmp_path) as store:
            masks.append([store.get_reached(light) for light in captured.snapshot.lights])
            assert (store._cycles is None) == (len(masks) == 2)
    for one, other in zip(*masks, strict=True):
        assert one.dtype == bool and np.array_equal(one, other) and one.shape == (160, 240)


@pytest.mark.parametrize("move", ["light", "camera"])
def test_changes_over_a_move(compare, move, tmp_path):
    """edsm moves with the truth; sm's steps crawl when the light moves. The scene is as it was afterwards."""
    document = compare(
        "--techniques", "sm,edsm", "--map-size", 128, "--border-samples", 1,
        "--temporal", move, "--temporal-frames", 3,
        *(("--temporal-step", 0.4) if move == "light" else ()),
    )  # fmt: skip
    found = {(record["light"], record["technique"]): record for record in document["temporal"]}
    assert set(found) == {(light, technique) for light in LIGHTS for technique in ("sm", "edsm")}
    for light in LIGHTS:
        sm, edsm = found[light, "sm"], found[light, "edsm"]
        assert (sm["move"], sm["frames"], sm["truth"]) == (move, 3, "hard")
        assert sm["step_deg"] == (0.4 if move == "light" else 0.02)
        # A moving camera leaves out the rim's pixels, and the plate's outline.
        assert sm["pixel_count"] == edsm["pixel_count"] > 2 * 0.6 * 240 * 160
        assert sm["measures"]["temporal_truth_rms"] > 0
        assert edsm["measures"]["temporal_rms"] < 0.6 * sm["measures"]["temporal_rms"], light
        assert edsm["measures"]["temporal_change_ratio"] == pytest.approx(1.0, abs=0.1), light
        if move == "light":
            assert sm["measures"]["temporal_change_ratio"] > 1.2, light
    assert "From frame to frame" in (tmp_path / "o" / "index.html").read_text()
    assert not [thing for thing in bpy.data.objects if thing.name.endswith(" moved")]
    assert [constraint.type for constraint in bpy.data.objects["Spot"].constraints] == ["TRACK_TO"]
    assert not bpy.data.objects["Sun"].constraints and not bpy.data.objects["Camera"].constraints


def test_changes_over_the_scene_s_own_frames(compare, capfd):
    arguments = ("--techniques", "sm", "--lights", "Spot", "--map-size", 128, "--border-samples", 1)
    document = compare(*arguments, "--frames", "1..3", "--temporal", "frames")
    record = document["temporal"][0]
    assert record["frames"] == 3 and record["step_deg"] is None and record["measures"]["temporal_truth_rms"] > 0
    capfd.readouterr()
    compare(*arguments, "--temporal", "frames", code=1)
    said = capfd.readouterr()
    assert "two frames or more: give them with --frames" in said.err
    assert "rendering" not in said.out  # told before anything takes time


def test_moves_are_tiny_the_same_and_undone(module, blend):
    """By the angle asked for, seen from the pivot; a sun turns on its spot; whatever moves the object has its say."""
    moves = module("scene_moves")
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.frame_set(6)
    things = [bpy.data.objects[name] for name in ("Sun", "Spot", "Camera")]

    def get_places():
        graph = bpy.context.evaluated_depsgraph_get()
        return {thing.name: thing.evaluated_get(graph).matrix_world.copy() for thing in things}

    before, count = get_places(), len(bpy.data.objects)
    pivot = Vector((0.1, 0.2, 0.0))
    with pytest.raises(KeyError), moves.Mover(scene, layer, things, pivot) as mover:
        mover.move(0.0)
        for name, matrix in get_places().items():
            assert_same(matrix, before[name])
        mover.move(0.01)
        moved = get_places()
        mover.move(0.0)
        mover.move(0.01)
        for name, matrix in get_places().items():
            assert_same(matrix, moved[name], 0.0)
        raise KeyError
    assert_turned(moved["Sun"], before["Sun"], 0.01)
    assert (moved["Sun"].translation - before["Sun"].translation).length < 1e-6
    for name in ("Spot", "Camera"):
        seen = [matrix.translation - pivot for matrix in (before[name], moved[name])]
        assert seen[0].angle(seen[1]) == pytest.approx(0.01, rel=1e-3)
        assert_turned(moved[name], before[name], 0.0)
    assert len(bpy.data.objects) == count
    for name, matrix in get_places().items():
        assert_same(matrix, before[name])
    scene.frame_set(7)  # the arm still moves the spot
    assert (get_places()["Spot"].translation - before["Spot"].translation).length > 1e-3


def assert_same(one: Matrix, other: Matrix, tolerance=2e-6):
    assert max(abs(a - b) for rows in zip(one, other, strict=True) for a, b in zip(*rows, strict=True)) <= tolerance


def assert_turned(one: Matrix, other: Matrix, angle):
    axes = [matrix.to_3x3() @ Vector((0, 0, 1)) for matrix in (one, other)]
    assert axes[0].cross(axes[1]).length / (axes[0].length * axes[1].length) == pytest.approx(math.sin(angle), abs=1e-5)


def test_light_in_the_pivot_still_moves(module):
    """The move needs a side to go to, also for a light in the middle of what is seen."""
    compute_move = module("scene_moves").compute_move
    start = Matrix.Translation((1, 2, 3))
    moved = compute_move(start, Vector((1, 2, 3)), 0.01, turns=False, farthest=8.0)
    assert 0 < (moved.translation - start.translation).length < 1e-3
