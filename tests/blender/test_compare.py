# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers against Cycles, by the batch's verb compare."""

import math
import re

import bpy
import numpy as np
import pytest

LIGHTS = ("Sun", "Spot", "Point", "Area")


def add(name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    made.location, made.rotation_euler = location, rotation
    return made


@pytest.fixture(scope="module")
def blend(addon, tmp_path_factory):
    """All four kinds of light, soft ones, over a ground with a turned cube and a smooth ball that moves."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=12)
    bpy.context.object.name = "Ground"
    bpy.ops.mesh.primitive_cube_add(size=1.2, location=(-0.9, 0.2, 0.9), rotation=(0.3, 0.2, 0.5))
    bpy.context.object.name = "Cube"
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, radius=0.7, location=(1.2, 0, 0.9))
    ball = bpy.context.object
    for polygon in ball.data.polygons:
        polygon.use_smooth = True
    for frame, z in ((1, 0.9), (2, 1.8)):
        ball.location.z = z
        ball.keyframe_insert("location", frame=frame)
    places = {
        "Sun": ((0, 0, 6), (0.5, 0.3, 0)),
        "Spot": ((-2, -2, 5), (0.4, -0.35, 0)),
        "Point": ((2, -1.5, 4), (0, 0, 0)),
        "Area": ((-1, 2.5, 4), (-0.6, 0, 0)),
    }
    for name, (location, rotation) in places.items():
        light = bpy.data.lights.new(name, name.upper())
        if name == "Sun":
            light.angle = 0.3
        elif name == "Area":
            light.size = 1.0
        else:
            light.shadow_soft_size = 0.4
        add(name, light, location, rotation)
    camera = bpy.data.cameras.new("Camera")
    camera.angle = math.radians(45)
    scene.camera = add("Camera", camera, (4.5, -6.5, 5.0), (math.radians(57), 0, math.radians(35)))
    scene.render.engine = "SHADOW_LAYERS"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 320, 180, 100
    scene.frame_set(1)
    path = tmp_path_factory.mktemp("compare") / "lights.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def index_records(document):
    return {(record["light"], record["technique"], record["frame"]): record for record in document["records"]}


def test_comparison_holds_every_measure_of_every_layer(compare, module, tmp_path):
    document = compare("--techniques", "sm,pcf,edsm", "--map-size", 512, "--no-cache")
    assert (document["schema"], document["schema_version"]) == ("shadow-layers-comparison", 1)
    assert document["blender"] == bpy.app.version_string and document["gl_renderer"] and document["revision"]
    records = index_records(document)
    assert set(records) == {(light, technique, 1) for light in LIGHTS for technique in ("sm", "pcf", "edsm")}
    ids = {info.id for info in module("compare.measures").MEASURES}
    assert set(document["measures"]) == ids
    for record in records.values():
        values = record["measures"]
        assert set(values) == ids
        assert record["truth_undecided"] == 0 and record["pixel_count"] > 5000
        assert record["pixel_count"] + sum(record["excluded"].values()) == 320 * 180
        assert set(record["truth_ms"]) == {"shadows_on", "shadows_off", "total"} and record["total_ms"] > 0
        assert record["settings"]["map_size"] == 512
        # Both look through the pixels' centres: they see the same surface in all but a handful of pixels.
        assert record["excluded"]["not_same_surface"] <= 6
        for key in ("layer_picture", "truth_picture", "difference_picture"):
            assert (tmp_path / "o" / record[key]).stat().st_size > 0
        assert values["misclassified_fraction"] < 0.03, record["light"]
        assert values["acne_fraction"] <= 0.0005 and values["leak_fraction"] <= 0.0005, record["light"]
    for light in LIGHTS:
        sm, edsm = (records[light, technique, 1]["measures"] for technique in ("sm", "edsm"))
        assert edsm["misclassified_fraction"] < 0.5 * sm["misclassified_fraction"] > 0, light
        # Hard layers are 0 or 1: all errors are whole pixels.
        assert sm["mae"] == pytest.approx(sm["misclassified_fraction"])
        assert sm["rmse"] == pytest.approx(math.sqrt(sm["misclassified_fraction"]))
    assert records["Spot", "sm", 1]["excluded"]["outside_cone"] > 1000
    assert records["Point", "sm", 1]["excluded"]["outside_cone"] == 0
    page = (tmp_path / "o" / "index.html").read_text()
    assert page.count("data:image/png;base64,") == 4 * (2 + 3 * 2)
    assert not re.search(r"https?://", re.sub(r"base64,[^\"]+", "", page))


def test_measures_agree_with_the_pictures(compare, module, tmp_path):
    """The wrong pixels of a hard layer, counted again from the truth and the layer's own arrays."""
    document = compare("--techniques", "sm", "--lights", "Point", "--map-size", 128)
    record = document["records"][0]
    scene = bpy.context.scene
    with module("engine").capture(aux=("position", "normal")) as captured:
        bpy.ops.render.render()
    frame = captured.frames[0]
    with module("truth").CyclesTruth(scene, scene.view_layers[0], 320, 180) as cycles:
        truth = cycles.render_light("Point")
    layer = frame.layers[0].channels["visibility"]
    to_light = np.array(bpy.data.objects["Point"].location) - np.array(frame.camera_position) - frame.aux["position"]
    faces = np.einsum("ijk,ijk->ij", to_light, frame.aux["normal"]) > 1e-3 * np.linalg.norm(to_light, axis=2)
    compared = faces & truth.lit & (frame.coverage > 0.5)
    wrong = int(((layer >= 0.5) != truth.visible)[compared].sum())
    assert abs(record["pixel_count"] - compared.sum()) <= 6
    assert wrong > 50
    assert abs(record["measures"]["misclassified_fraction"] * record["pixel_count"] - wrong) <= 2


def test_second_run_renders_no_truth(compare, module, monkeypatch, cache_folder, tmp_path):
    arguments = ("--techniques", "edsm", "--lights", "Sun", "Area")
    first = compare(*arguments, out=tmp_path / "a")

    def fail(*_):
        raise AssertionError("Cycles was called")

    monkeypatch.setattr(module("truth").CyclesTruth, "__enter__", fail)
    second = compare(*arguments, out=tmp_path / "b")
    assert all(record["truth_cached"] for record in second["records"])
    assert second["frames"][0]["truth_surface_cached"]
    for one, other in zip(first["records"], second["records"], strict=True):
        for key in ("measures", "excluded", "truth_ms", "pixel_count", "flip"):
            assert one[key] == other[key]
    for record in second["records"]:
        for key in ("layer_picture", "truth_picture", "difference_picture"):
            assert (tmp_path / "a" / record[key]).read_bytes() == (tmp_path / "b" / record[key]).read_bytes()


def test_changed_scene_is_rendered_anew(compare, tmp_path, blend):
    compare("--techniques", "sm", "--lights", "Sun", out=tmp_path / "a")
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.data.objects["Cube"].location.x += 0.1
    changed = tmp_path / "changed.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(changed))
    moved = compare("--techniques", "sm", "--lights", "Sun", file=changed, out=tmp_path / "b")
    assert not moved["records"][0]["truth_cached"] and moved["records"][0]["measures"]["misclassified_fraction"] < 0.03
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.data.lights["Sun"].energy = 7.0  # doesn't change the truth
    bpy.ops.wm.save_as_mainfile(filepath=str(changed))
    brighter = compare("--techniques", "sm", "--lights", "Sun", file=changed, out=tmp_path / "c")
    assert brighter["records"][0]["truth_cached"]


def test_frames_and_skipping(compare, tmp_path, capfd):
    arguments = ("--techniques", "sm", "--lights", "Spot", "--frames", "1..2", "--samples", 8)
    document = compare(*arguments)
    records = index_records(document)
    assert set(records) == {("Spot", "sm", 1), ("Spot", "sm", 2)}
    assert [frame["samples"] for frame in document["frames"]] == [1, 1]
    assert "compare takes one sample" in capfd.readouterr().out
    one, other = ((tmp_path / "o" / records["Spot", "sm", frame]["truth_picture"]).read_bytes() for frame in (1, 2))
    assert one != other  # the ball has moved
    for record in records.values():
        assert record["measures"]["misclassified_fraction"] < 0.03
    compare(*arguments, "--skip-existing")
    assert "is there already" in capfd.readouterr().out
    (tmp_path / "o" / "index.html").unlink()
    compare(*arguments, "--skip-existing")
    assert "rendering the layers" in capfd.readouterr().out


def test_repeats_tell_times_of_cached_maps(compare):
    document = compare("--techniques", "sm", "--lights", "Sun", "--repeat", 3)
    assert document["records"][0]["again_ms"] > 0 and document["frames"][0]["render_again_ms"] > 0
    assert compare("--techniques", "sm", "--lights", "Sun")["records"][0]["again_ms"] is None


@pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="light linking came with Blender 4.0")
def test_linked_lights(compare, blend, tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    receivers = bpy.data.collections.new("Receivers")
    receivers.objects.link(bpy.data.objects["Ground"])
    bpy.data.objects["Sun"].light_linking.receiver_collection = receivers
    blockers = bpy.data.collections.new("Blockers")
    blockers.objects.link(bpy.data.objects["Cube"])
    bpy.data.objects["Point"].light_linking.blocker_collection = blockers
    linked = tmp_path / "linked.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(linked))
    records = index_records(compare("--techniques", "edsm", "--lights", "Sun", "Point", file=linked))
    assert records["Sun", "edsm", 1]["excluded"]["not_linked"] > 500
    assert records["Point", "edsm", 1]["excluded"]["not_linked"] == 0
    for record in records.values():
        assert record["measures"]["misclassified_fraction"] < 0.005


def test_antialiased_layers_meet_the_pixel_truth(compare):
    """afsm names it for several samples; against it they are worth more than one, and the border lies where it does."""
    settings = ("--techniques", "afsm", "--lights", "Point", "--resolution", "160x90", "--truth-samples", 256)
    one = compare(*settings, "--truth", "named,pixel")["records"]
    many = compare(*settings, "--set", "afsm.samples=64")["records"]
    assert [record["truth"]["kind"] for record in (*one, *many)] == ["hard", "pixel", "pixel"]
    for record in (one[1], many[0]):
        assert record["truth"]["samples"] == 256 and record["truth_ms"]["total"] > 0
        assert abs(record["measures"]["border_bias_px"]) < 0.05
        assert abs(record["measures"]["signed_bias"]) < 3 * record["truth"]["standard_error"]["bias"] + 1e-3
    assert one[0]["measures"]["border_mae"] is None
    assert many[0]["measures"]["border_mae"] < 0.025
    assert one[1]["measures"]["border_mae"] > 0.15
    assert many[0]["measures"]["staircase_px"] < 0.1


def test_each_layer_meets_the_truths_asked_for(compare, module, monkeypatch, tmp_path):
    """pcf names the filtered truth, sm the hard one; soft is asked for of both, and is one picture for both."""
    arguments = ("--techniques", "sm,pcf", "--lights", "Area", "--resolution", "160x90", "--map-size", 256, "--set",
                 "pcf.kernel=7", "--truth", "named,soft", "--truth-samples", 16)  # fmt: skip
    document = compare(*arguments, out=tmp_path / "a")
    assert (document["truths"], document["truth_samples"]) == (["named", "soft"], 16)
    records = {(record["technique"], record["truth"]["kind"]): record for record in document["records"]}
    assert set(records) == {("sm", "hard"), ("sm", "soft"), ("pcf", "filtered"), ("pcf", "soft")}
    assert records["pcf", "filtered"]["truth"]["footprint_texels"] == 7
    for (_, kind), record in records.items():
        reported = record["truth"]["standard_error"]
        assert record["truth"]["samples"] == (1 if kind == "hard" else 16)
        assert (reported["rms"] > 0) == (reported["bias"] > 0) == (kind != "hard")
        assert reported["bias"] < 0.02 * reported["rms"] or kind == "hard"
        assert record["measures"]["rmse"] > reported["rms"]
    assert records["pcf", "filtered"]["measures"]["mae"] < 0.7 * records["pcf", "soft"]["measures"]["mae"]
    assert records["sm", "soft"]["truth_picture"] == records["pcf", "soft"]["truth_picture"]
    pictures = [record[name] for record in records.values() for name in ("difference_picture", "truth_picture")]
    assert len(set(pictures)) == 4 + 3 and all((tmp_path / "a" / name).stat().st_size for name in pictures)
    page = (tmp_path / "a" / "index.html").read_text()
    assert "over a square of 7 texels, 16 samples" in page and "too dark by 0.25 or more" in page

    def fail(*_, **__):
        raise AssertionError("a truth was made anew")

    monkeypatch.setattr(module("truth").CyclesTruth, "__enter__", fail)
    monkeypatch.setattr(module("truth_store"), "compute_filtered_truth", fail)
    again = compare(*arguments, out=tmp_path / "b")
    for one, other in zip(document["records"], again["records"], strict=True):
        assert (
            one["measures"] == other["measures"] and one["truth"]["standard_error"] == other["truth"]["standard_error"]
        )
        assert other["truth"]["cached"]
    monkeypatch.undo()
    finer = compare(*arguments[:-1], 32, "--skip-existing", out=tmp_path / "b")["records"]
    assert [record["truth"]["cached"] for record in finer] == [True, False, False, False]


def test_wrong_pixels_are_sorted_by_cause(compare):
    """A coarse map's wrong pixels are the technique's own; few without texels are wrong, none by their fault."""
    arguments = ("--techniques", "sm,exact", "--map-size", 64)
    plain = index_records(compare(*arguments))
    assert not any("causes" in record for record in plain.values())
    for (light, technique, _), record in index_records(compare(*arguments, "--causes", 60)).items():
        causes = record["causes"]
        wrong = record["measures"]["misclassified_fraction"] * record["pixel_count"]
        assert causes["wrong"] == round(wrong)
        assert causes["sorted"] == len(causes["pixels"]) == min(causes["wrong"], 60) == sum(causes["counts"].values())
        assert causes["counts"]["unexplained"] == 0, light
        assert 200 < record["true_border_pixels"] < 0.3 * record["pixel_count"]
        if technique == "sm":
            assert causes["wrong"] > 60 and causes["counts"]["technique"] >= 58, light
        else:
            assert causes["counts"]["technique"] == 0 and causes["wrong"] <= 3, light


def test_several_view_layers_must_be_chosen(compare, blend, tmp_path, capfd):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.context.scene.view_layers.new("Second")
    two = tmp_path / "two.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(two))
    compare("--techniques", "sm", file=two, code=1)
    assert 'several view layers are enabled ("ViewLayer", "Second"): choose' in capfd.readouterr().err
    document = compare("--techniques", "sm", "--lights", "Sun", "--view-layer", "Second", file=two)
    assert document["view_layer"] == "Second"


def test_instanced_lights_are_refused_before_anything_is_written(compare, blend, tmp_path, capfd):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    collection = bpy.data.collections.new("Lamps")
    collection.objects.link(bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT")))
    empty = add("Instancer", None, (1, 0, 3))
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    changed = tmp_path / "instanced.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(changed))
    compare("--techniques", "sm", file=changed, code=1)
    assert '"Lamp @Instancer" is no light object' in capfd.readouterr().err
    assert list((tmp_path / "o").iterdir()) == []


def test_truth_leaves_nothing_behind(module, blend):
    """The comparison's renders put back what they change: no datablock and no file more after many."""
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    scene = bpy.context.scene
    counts = []
    for _ in range(4):
        with module("truth").CyclesTruth(scene, scene.view_layers[0], 32, 18) as cycles:
            cycles.render_surface()
            for name in LIGHTS:
                cycles.render_light(name)
        counts.append({name: len(getattr(bpy.data, name)) for name in ("lights", "materials", "images", "node_groups")})
    assert counts[1:] == counts[:-1]


def test_box_meets_its_promise(compare, scene_file):
    """At 1280 x 720 with a map of 1024: edsm has at most a twentieth of sm's wrong pixels."""
    document = compare(
        "--techniques", "sm,pcf,edsm", "--resolution", "1280x720", "--map-size", 1024, file=scene_file("box")
    )
    measures = {record["technique"]: record["measures"] for record in document["records"]}
    wrong = {technique: values["misclassified_fraction"] for technique, values in measures.items()}
    assert 0 < wrong["sm"] < 0.005
    assert wrong["edsm"] <= 0.05 * wrong["sm"]
    for values in measures.values():
        assert values["acne_fraction"] <= 0.0005 and values["leak_fraction"] <= 0.0005
