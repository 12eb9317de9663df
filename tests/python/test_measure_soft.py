# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of `make measure NAMES="soft soft_speed soft_cycles"`, from documents of the benchmark and of Blender."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

import measure_soft
import small_scene
import snapshot as snapshot_module


def spread(median):
    return {"median": median}


def make_bits(samples, **changes):
    bits = {"light_samples": samples, "bits": 1000 * samples, "wrong_bits": 0, "wrong_pixels": 0,
            "penumbra_pixels": 70, "ties": 3}  # fmt: skip
    return {"technique": "soft", "bits": bits | changes}


def test_any_wrong_bit_is_over_the_bound():
    document = {"records": [make_bits(16), make_bits(64, wrong_bits=1), make_bits(256, bits=0)]}
    rows = measure_soft.judge_bits("hall", "medium", document)
    assert [good for _, good in rows] == [True, False, False]
    assert rows[0][0] == ["hall", "medium", 16, 16000, 0, 3, 70]
    assert all(len(cells) == len(measure_soft.kBitColumns) for cells, _ in rows)


def make_documents(soft=200.0, hard=40.0, trees=30.0, trace=600.0, triangles=100_000):
    def record(technique, layers, stage):
        return {"technique": technique, "layers_ms": spread(layers), "triangles": triangles,
                "stage_ms": {"caster_trees": spread(stage)}}  # fmt: skip

    rays = [{"name": "low", "build_ms": spread(20.0), "trace_ms": spread(trace)},
            {"name": "medium", "build_ms": spread(90.0), "trace_ms": spread(trace)}]  # fmt: skip
    warm = {"records": [record("exact", hard, 0.0), record("soft", soft, 5.0)], "rays": rays}
    return warm, {"records": [record("soft", soft + trees, 5.0 + trees)]}


def test_times_are_told_in_hard_layers_and_next_to_the_quickest_rays():
    times = measure_soft.read_times(*make_documents())
    assert (times.layers, times.trees, times.embree, times.way) == (5.0, 30.0, 620.0, "low")
    assert times.layers_with_trees == pytest.approx(5.75)
    assert times.to_embree == pytest.approx(230 / 620)
    cells, good = measure_soft.judge_speed("knot", "small", times)
    assert good and len(cells) == len(measure_soft.kSpeedColumns)
    assert cells[4:8] == ["5.0", "5", "4", "5.8"]


@pytest.mark.parametrize(
    ("changes", "size"),
    [
        ({"soft": 201.0}, "small"),
        ({"soft": 481.0}, "medium"),
        ({"soft": 1201.0, "trace": 9000.0}, "large"),
        ({"trace": 150.0}, "medium"),
        ({"trees": 90.0}, "medium"),
    ],
)
def test_times_over_a_bound_are_found(changes, size):
    assert not measure_soft.judge_speed("knot", size, measure_soft.read_times(*make_documents(**changes)))[1]


def test_trees_of_large_scenes_have_no_bound_of_their_own():
    times = measure_soft.read_times(*make_documents(trees=90.0, triangles=1_200_000))
    assert measure_soft.judge_speed("city", "medium", times)[1]


def test_the_median_next_to_embree_has_its_bound():
    near, far = (measure_soft.read_times(*make_documents(trace=trace)) for trace in (300.0, 2000.0))
    cells, good = measure_soft.judge_median([far, far, near])
    assert good and len(cells) == len(measure_soft.kSpeedColumns)
    assert not measure_soft.judge_median([far, near, near])[1]


def make_renders(*errors, ms):
    renders = [{"samples": 2**k, "error": error} for k, error in enumerate(errors)]
    renders[-1]["ms"] = ms
    return renders


def test_the_cheaper_of_cycles_renders_of_the_same_error_counts():
    found = {"error": 0.01, "f12_ms": spread(250.0), "plain": make_renders(0.1, 0.04, 0.009, ms=40_000.0),
             "denoised": make_renders(0.03, 0.008, ms=16_000.0)}  # fmt: skip
    cells, good = measure_soft.judge_cycles("jenga", found)
    assert good and len(cells) == len(measure_soft.kCyclesColumns)
    assert cells[3:9] == ["40.0 s", "4", "0.90", "16.0 s", "2", "0.80"] and cells[9] == "64"
    found["denoised"] = make_renders(0.008, ms=14_000.0)
    assert not measure_soft.judge_cycles("jenga", found)[1]
    found["denoised"] = make_renders(0.03, 0.011, ms=9_000.0)  # never as good
    cells, good = measure_soft.judge_cycles("jenga", found)
    assert good and cells[7] == "over 2" and cells[9] == "160"


def test_errors_next_to_cycles_have_a_bound_for_each_number_of_samples():
    soft = [{"samples": 64, "error": 0.0099, "bias": -0.001}, {"samples": 256, "error": 0.0031, "bias": 0.0}]
    rows = measure_soft.judge_errors("jenga", {"penumbra": 900, "truth_error": 0.004, "soft": soft})
    assert [good for _, good in rows] == [True, False]
    assert rows[0][0] == ["jenga", 900, "0.40", 64, "0.99", "-0.10", "1"]
    assert all(len(cells) == len(measure_soft.kErrorColumns) for cells, _ in rows)


@pytest.mark.parametrize(
    ("kind", "size", "expected"),
    [
        ("SUN", 5.0, ("sun_angle", math.radians(5))),
        ("SPOT", 0.5, ("radius", 0.5)),
        ("AREA", 3.0, ("area_size", (3, 2))),
    ],
)
def test_a_snapshots_light_is_given_another_size(tmp_path, kind, size, expected):
    s = snapshot_module
    lights = [s.LightData(name, kind, small_scene.looking_down(5.0), area_size=(0.9, 0.6)) for name in ("Key", "Other")]
    scene = s.SceneSnapshot(
        camera=s.CameraData(False, (-4, 4, -3, 3), 0.1, 100.0, small_scene.looking_down(10.0)),
        render=s.RenderSettings(64, 48, (0, 0, 64, 48)),
        meshes=[s.MeshData("ground", small_scene.GROUND, small_scene.GROUND_TRIANGLES)],
        instance_mesh=np.array([0], np.uint32), instance_matrix=np.eye(4)[None],
        instance_flags=np.array([3], np.uint32), instance_receiver_group=np.zeros(1, np.uint8),
        instance_blocker_group=np.zeros(1, np.uint8), lights=lights, jobs=[s.Job(1, "sm", {})],
    )  # fmt: skip
    scene.save(tmp_path / "a.npz")
    resized = s.SceneSnapshot.load(measure_soft.resize_light(tmp_path / "a.npz", "Key", size, tmp_path / "b.npz"))
    assert [light.name for light in resized.lights] == ["Key"] and resized.jobs == []
    assert getattr(resized.lights[0], expected[0]) == pytest.approx(expected[1])
    with pytest.raises(ValueError, match="Bulb"):
        measure_soft.resize_light(tmp_path / "a.npz", "Bulb", size, tmp_path / "c.npz")


def test_the_scenes_have_the_lights_that_are_measured(root):
    assert len(measure_soft.kScenes) == 7
    for scene in measure_soft.kScenes:
        text = (root / "test_scenes" / f"{scene.script}.py").read_text(encoding="utf-8")
        assert f'"{scene.light}"' in text, scene.name
        assert scene.sizes == tuple(sorted(scene.sizes))
    assert set(measure_soft.kCyclesScenes) <= {scene.name for scene in measure_soft.kScenes}
