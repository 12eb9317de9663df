# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""shadowcore from outside: what it writes, what it says, what it returns."""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
import small_scene

DATA = Path(__file__).resolve().parents[1] / "data"


@pytest.fixture(scope="module")
def snapshot_module(root):
    sys.path.insert(0, str(root / "addon"))
    try:
        import snapshot  # by itself: the package would want bpy
    finally:
        sys.path.remove(str(root / "addon"))
    return snapshot


@pytest.fixture(scope="module")
def make_snapshot(snapshot_module, tmp_path_factory):
    """Writes the box over the ground, seen from above, as the add-on does."""

    def make(name="scene.npz", **changes):
        s = snapshot_module
        light = s.LightData(name="Key", kind="SUN", world_from_light=small_scene.looking_down(5.0))
        spot = s.LightData(
            name="Rim.001/é", kind="SPOT", world_from_light=small_scene.looking_down(8.0), spot_angle=1.5
        )
        scene = s.SceneSnapshot(
            camera=s.CameraData(False, (-4, 4, -3, 3), 0.1, 100.0, small_scene.looking_down(10.0)),
            render=s.RenderSettings(64, 48, (0, 0, 64, 48)),
            meshes=[
                s.MeshData("ground", small_scene.GROUND, small_scene.GROUND_TRIANGLES),
                s.MeshData("box", small_scene.BOX, small_scene.BOX_TRIANGLES),
            ],
            instance_mesh=np.array([0, 1], np.uint32),
            instance_matrix=np.stack([np.eye(4), np.eye(4)]),
            instance_flags=np.array([3, 2], np.uint32),
            instance_receiver_group=np.zeros(2, np.uint8),
            instance_blocker_group=np.zeros(2, np.uint8),
            lights=[light, spot],
            jobs=[s.Job(0, "sm", {"map_size": 256}), s.Job(1, "pcf", {"kernel": 5})],
            source={"view_layer": "View", "frame": 12, "scene": "Scene"},
        )
        for key, value in changes.items():
            setattr(scene, key, value)
        path = tmp_path_factory.mktemp("snapshot") / name
        scene.save(path)
        return path

    return make


@pytest.fixture(scope="module")
def snapshot(make_snapshot):
    return make_snapshot()


@pytest.fixture
def run(shadowcore, tmp_path):
    def start(*arguments, cwd=tmp_path, env=None, **options):
        return subprocess.run(
            [str(shadowcore), *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
            cwd=cwd,
            env=os.environ | (env or {}),
            **options,
        )

    return start


def read_png(path):
    """Rows of an 8-bit PNG, top first: enough of the format for the files written here."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, body = 8, b""
    while place < len(data):
        length, kind = int.from_bytes(data[place : place + 4], "big"), data[place + 4 : place + 8]
        chunk = data[place + 8 : place + 8 + length]
        if kind == b"IHDR":
            width, height = int.from_bytes(chunk[:4], "big"), int.from_bytes(chunk[4:8], "big")
            channels = {0: 1, 2: 3, 6: 4}[chunk[9]]
        body += chunk if kind == b"IDAT" else b""
        place += 12 + length
    raw = np.frombuffer(zlib.decompress(body), np.uint8).reshape(height, 1 + width * channels)
    rows = np.zeros((height, width * channels), np.int64)
    for y in range(height):
        above = rows[y - 1] if y else np.zeros(width * channels, np.int64)
        for x in range(width * channels):
            left = rows[y, x - channels] if x >= channels else 0
            corner = above[x - channels] if x >= channels else 0
            estimate = left + above[x] - corner
            paeth = min((left, above[x], corner), key=lambda v, e=estimate: abs(e - v))
            rows[y, x] = (raw[y, x + 1] + (0, left, above[x], (left + above[x]) // 2, paeth)[raw[y, 0]]) & 255
    return rows.reshape(height, width, channels)


def test_a_snapshot_of_the_add_on_is_rendered(run, snapshot, tmp_path):
    done = run("render", snapshot, "--out", "layers")
    assert (done.returncode, done.stderr) == (0, "")
    out = tmp_path / "layers"
    assert sorted(path.name for path in out.iterdir()) == [
        "Key_sm.png",
        "Rim_001_é_pcf.png",
        "combined.png",
        "layers.exr",
        "render.json",
    ]
    document = json.loads((out / "render.json").read_text(encoding="utf-8"))
    assert (document["schema"], document["schema_version"]) == ("shadow-layers-render", 1)
    for key in ("shadow_layers", "revision", "blender", "gl_renderer", "gl_version", "backend", "file", "scene"):
        assert isinstance(document[key], str)
    first, second = document["layers"]
    assert {"file", "channel", "light", "technique", "frame", "settings", "time_ms"} <= set(first)
    assert (first["light"], first["technique"], first["frame"]) == ("Key", "sm", 12)
    assert first["channel"] == "View.Shadow Key sm.X" and first["settings"] == {
        "map_size": 256,
        "light_samples": 1,
        "light_pattern": "spiral",
    }
    assert second["light"] == "Rim.001/é" and second["settings"]["kernel"] == 5
    assert second["channel"] == "View.Shadow Rim_001/é pcf.X"
    assert all(ms >= 0 for layer in document["layers"] for ms in layer["time_ms"].values())
    assert document["frames"][0]["triangles"] == 14
    width, height = document["frames"][0]["resolution"]
    assert document["frames"][0]["region"] == [0, 0, width, height]
    mask = read_png(out / "Key_sm.png")[..., 0]
    assert mask.shape == (48, 64) and set(np.unique(mask)) == {0, 255}
    assert abs((mask == 0).sum() - 16 * 16) < 70 and mask[24, 32] == 0


def test_exr_and_png_hold_the_same_layer(run, snapshot, tmp_path):
    if not shutil.which("oiiotool"):
        pytest.fail("oiiotool is missing: run scripts/setup.sh build")
    assert run("render", snapshot, "--out", "a").returncode == 0
    listing = subprocess.run(
        ["oiiotool", "-v", "-a", "--info", "a/layers.exr"], capture_output=True, text=True, check=True, cwd=tmp_path
    ).stdout
    for text in (
        "View.Shadow Key sm.X",
        "View.Combined.R",
        "View.Coverage.X",
        "shadow_layers.technique",
        "shadow_layers.settings",
        "map_size",
    ):
        assert text in listing
    convert = ["oiiotool", "a/layers.exr", "--subimage", "0", "-d", "uint8", "-o", "b.png"]
    subprocess.run(convert, check=True, capture_output=True, cwd=tmp_path)
    assert np.array_equal(read_png(tmp_path / "b.png")[..., 0], read_png(tmp_path / "a" / "Key_sm.png")[..., 0])


def test_the_module_and_the_program_agree(run, core, shader_dir, snapshot, tmp_path):
    assert run("render", snapshot, "--techniques", "edsm", "--lights", "Key", "--out", "a").returncode == 0
    scene = small_scene.make_scene(core)
    camera = core.Camera(
        perspective=False,
        window=(-4, 4, -3, 3),
        clip_start=0.1,
        clip_end=100.0,
        world_from_camera=small_scene.looking_down(10.0),
    )
    with core.Session(shader_dir=shader_dir) as session:
        (layer,) = session.render(scene, camera, [(0, "edsm", {})], width=64, height=48).layers
    wanted = np.round(layer.channels["visibility"][::-1] * 255)
    assert np.array_equal(read_png(tmp_path / "a" / "Key_edsm.png")[..., 0], wanted)


def test_options_choose_and_override(run, snapshot, tmp_path):
    done = run(
        *(
            "render",
            snapshot,
            "--techniques",
            "sm,pcf",
            "--lights",
            "Rim.001/é",
            "--map-size",
            128,
            "--set",
            "pcf.kernel=7",
        ),
        *("--set", "pcf.bilinear=true", "--resolution", "80x20", "--samples", 2, "--json", "list.json", "--out", "o"),
    )
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "list.json").read_text(encoding="utf-8"))
    assert [(layer["light"], layer["technique"]) for layer in document["layers"]] == [
        ("Rim.001/é", "sm"),
        ("Rim.001/é", "pcf"),
    ]
    assert document["layers"][1]["settings"] == document["layers"][1]["settings"] | {
        "kernel": 7,
        "bilinear": True,
        "map_size": 128,
    }
    assert document["frames"][0]["resolution"] == [80, 20] and document["frames"][0]["samples"] == 2
    assert not (tmp_path / "o" / "render.json").exists()


@pytest.mark.parametrize("name", ["box.gltf", "box.obj"])
def test_files_made_by_hand_are_rendered(run, name, tmp_path):
    done = run("render", DATA / name, "--techniques", "sm", "--resolution", "96x64", "--out", "o")
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "o" / "render.json").read_text(encoding="utf-8"))
    masks = {layer["light"]: read_png(tmp_path / "o" / layer["picture"]) for layer in document["layers"]}
    for light, mask in masks.items():
        assert 0.01 < (mask == 0).mean() < 0.9, light
    assert set(masks) == ({"Sun", "Lamp", "Torch"} if name == "box.gltf" else {"Default Sun"})


def test_pictures_repeat_bit_for_bit(run, snapshot, tmp_path):
    for out in ("a", "b"):
        assert run("render", snapshot, "--techniques", "sm,pcf,edsm", "--out", out).returncode == 0
    names = sorted(path.name for path in (tmp_path / "a").glob("*.png"))
    assert len(names) == 7
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_help_names_every_technique_and_parameter(run, core):
    text = run("--help").stdout
    for technique in core.techniques():
        if technique["test_only"]:
            assert f"{technique['id']}." not in text
            continue
        for parameter in technique["parameters"]:
            assert f"{technique['id']}.{parameter['id']}=" in text
    for verb, option in {"render": "--out", "bench": "--repeat", "info": "--json"}.items():
        help_text = run(verb, "--help")
        assert help_text.returncode == 0 and option in help_text.stdout


def test_info_lists_what_there_is(run, core, tmp_path):
    done = run("info", "--json", "info.json")
    assert done.returncode == 0
    info = json.loads((tmp_path / "info.json").read_text(encoding="utf-8"))
    assert info["techniques"] == core.techniques()
    assert info["version"] == core.__version__ and info["max_texture_size"] >= 1024 and info["gl_renderer"]
    assert info["gl_renderer"] in done.stdout
    assert run("--version").stdout.startswith(core.__version__)


def test_bench_measures_a_grid(run, snapshot, tmp_path):
    done = run(
        *(
            "bench",
            snapshot,
            DATA / "box.obj",
            "--techniques",
            "sm,pcf",
            "--set",
            "pcf.kernel=1,3",
            "--map-size",
            "64,128",
        ),
        *("--repeat", 3, "--resolution", "32x32", "--json", "bench.json"),
    )
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))
    assert (document["schema"], document["caches"], document["repeat"]) == ("shadow-layers-bench", "frame", 3)
    records = document["records"]
    assert len(records) == 2 * (2 + 4)
    for record in records:
        spread = record["render_ms"]
        assert spread["count"] == 3
        assert 0 < spread["min"] <= spread["quartile_1"] <= spread["median"] <= spread["quartile_3"] <= spread["max"]
        assert record["frame_ms"]["median"] + record["layers_ms"]["median"] < 1.5 * spread["median"] + 5
        assert record["time_ms"] and record["ratio_to_sm"] > 0
        if record["technique"] == "sm":
            assert record["ratio_to_sm"] == 1
            assert "depth_map" in record["time_ms"], "nothing of the frame may come from the cache"
    assert {record["settings"]["map_size"] for record in records} == {64, 128}
    assert "pcf" in done.stdout and "ratio" in done.stdout


@pytest.mark.parametrize("mode", ["warm", "cold"])
def test_bench_of_other_cache_states(run, snapshot, mode):
    done = run("bench", snapshot, "--techniques", "sm", "--repeat", 2, "--caches", mode, "--resolution", "32x32")
    assert done.returncode == 0, done.stderr
    assert ("depth_map" in done.stdout) == (mode == "cold")


def write_rows(tmp_path, rows):
    (tmp_path / "rows.json").write_text(json.dumps(rows), encoding="utf-8")
    return "rows.json"


def test_bench_measures_antialiased_layers_against_the_pixels_squares(run, snapshot, tmp_path):
    """The shadow's sides lie in columns 56 and 93, rows 36 and 73; more places in a pixel are nearer to its part."""
    rows = [{"technique": "afsm", "settings": {"samples": samples}} for samples in (1, 4, 64)]
    done = run(
        *("bench", snapshot, "--rows", write_rows(tmp_path, rows), "--errors", "--lights", "Key", "--repeat", 1),
        *("--resolution", "150x110", "--samples", 1, "--json", "bench.json"),
    )
    assert done.returncode == 0, done.stderr
    records = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))["records"]
    one, few, many = (record["errors"] for record in records)
    assert [errors["truth"] for errors in (one, few, many)] == ["hard", "pixel", "pixel"]
    assert one["own"]["wrong_fraction"] < 1e-4, "at the pixels' centres it is exact"
    assert one["own"]["border_pixels"] == 0 and one["own"]["border_mean_absolute"] is None
    assert few["own"]["border_pixels"] == many["own"]["border_pixels"] == 4 * 38 - 4
    assert many["own"]["border_mean_absolute"] < 0.02 < few["own"]["border_mean_absolute"] < 0.15
    for errors in (few, many):
        own = errors["own"]
        assert own["mean_absolute"] * own["pixels"] == pytest.approx(
            own["border_mean_absolute"] * own["border_pixels"], rel=0.1
        )
    assert f"border {many['own']['border_mean_absolute']:.5f}" in done.stdout


@pytest.fixture(scope="module")
def bulb_snapshot(make_snapshot, snapshot_module):
    """The box over the ground, under a bulb."""
    place = small_scene.looking_down(8.0)
    place[0][3], place[2][3] = 0.3, 0.2
    bulb = snapshot_module.LightData(name="Bulb", kind="POINT", world_from_light=place, radius=0.5)
    return make_snapshot(name="bulb.npz", lights=[bulb], jobs=[])


def test_bench_counts_the_wrong_bits_of_soft_layers(run, bulb_snapshot, tmp_path):
    """Rays to the very samples: an exact layer of few samples is right, one of coarse maps is not."""
    soft = {"technique": "multi", "settings": {"positions": 9, "technique": "exact"}}
    coarse = {"technique": "multi", "settings": {"positions": 9, "technique": "sm", "map_size": 16}}
    done = run(
        *("bench", bulb_snapshot, "--rows", write_rows(tmp_path, [soft, coarse, {"technique": "sm"}]), "--bits"),
        *("--repeat", 1, "--resolution", "160x120", "--samples", 1, "--json", "bench.json"),
    )
    assert done.returncode == 0, done.stderr
    records = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))["records"]
    right, wrong, hard = (record["bits"] for record in records)
    assert hard is None and records[0]["errors"] is None
    assert right["light_samples"] == 9 and right["bits"] == 9 * 160 * 120
    assert right["wrong_bits"] == right["wrong_pixels"] == 0
    assert right["penumbra_pixels"] > 500 and right["ties"] < 20
    assert wrong["wrong_bits"] >= wrong["wrong_pixels"] > 100
    assert f"0 wrong bits of {right['bits']}" in done.stdout


def test_bench_counts_no_bits_where_each_pixel_takes_samples_of_its_own(run, bulb_snapshot, tmp_path):
    rows = [
        {"technique": "soft", "settings": {"pattern": pattern, "light_samples": 9}} for pattern in ("fixed", "rotated")
    ]
    options = ("--bits", "--repeat", 1, "--resolution", "160x120", "--samples", 1, "--json", "bench.json")
    done = run("bench", bulb_snapshot, "--rows", write_rows(tmp_path, rows), *options)
    assert_fails(done, "pattern = fixed", '"soft"')
    assert not (tmp_path / "bench.json").exists()
    done = run("bench", bulb_snapshot, "--rows", write_rows(tmp_path, rows[:1]), *options)
    assert done.returncode == 0, done.stderr
    [record] = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))["records"]
    assert record["bits"]["wrong_bits"] == 0 and record["bits"]["penumbra_pixels"] > 500


def test_bench_tells_the_standard_error_of_a_soft_truth(run, bulb_snapshot, tmp_path):
    rows = [{"technique": "multi", "settings": {"positions": n, "technique": "exact"}} for n in (4, 64)]
    done = run(
        *("bench", bulb_snapshot, "--rows", write_rows(tmp_path, rows), "--errors", "--repeat", 1),
        *("--resolution", "80x60", "--samples", 1, "--json", "bench.json"),
    )
    assert done.returncode == 0, done.stderr
    few, many = (r["errors"] for r in json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))["records"])
    assert few["truth"] == many["truth"] == "soft"
    assert 0 < many["truth_standard_error"] == few["truth_standard_error"] < 0.01
    assert many["own"]["border_mean_absolute"] < 0.015 < few["own"]["border_mean_absolute"]


def test_bench_times_rays_to_all_samples_of_a_light(run, bulb_snapshot, tmp_path):
    rows = [{"technique": "sm"}, {"technique": "multi", "settings": {"positions": 16}}]
    done = run(
        *("bench", bulb_snapshot, "--rows", write_rows(tmp_path, rows), "--rays", "--repeat", 2),
        *("--resolution", "64x48", "--json", "bench.json"),
    )
    assert done.returncode == 0, done.stderr
    rays = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))["rays"]
    assert len(rays) == 4
    for way in rays:
        assert way["receivers"] == 64 * 48 and way["rays"] == 16 * 64 * 48
        assert way["trace_ms"]["count"] == 2 and way["build_ms"]["median"] > 0
        assert 0 < way["trace_ms"]["median"] <= min(way["packets_ms"]["max"], way["stream_ms"]["max"])


def test_bench_measures_rows_and_their_errors(run, snapshot, tmp_path):
    """Coarser maps are further from the rays; a filter is nearer to its own truth than to the hard mask."""
    rows = [
        {"technique": "sm", "settings": {"map_size": 16}},
        {"technique": "sm", "settings": {"map_size": 1024}},
        {"name": "wide", "technique": "pcf", "settings": {"map_size": 64, "kernel": 5, "bilinear": True}},
    ]
    done = run(
        *("bench", snapshot, "--rows", write_rows(tmp_path, rows), "--errors", "--lights", "Key", "--repeat", 2),
        *("--resolution", "160x120", "--samples", 1, "--json", "bench.json"),
    )
    assert done.returncode == 0, done.stderr
    coarse, fine, wide = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))["records"]
    assert (coarse["settings"]["map_size"], fine["settings"]["map_size"], wide["name"]) == (16, 1024, "wide")
    assert wide["settings"]["bilinear"] is True
    wrong = [record["errors"]["hard"]["wrong_fraction"] for record in (coarse, fine)]
    assert wrong[1] < 0.004 < wrong[0] < 0.2
    for record in (coarse, fine):
        errors = record["errors"]
        assert errors["truth"] == "hard" and errors["own"] == errors["hard"]
        assert errors["hard"]["pixels"] == 160 * 120
        assert errors["hard"]["mean_absolute"] == pytest.approx(errors["hard"]["wrong_fraction"]), "sm is 0 or 1"
    errors = wide["errors"]
    assert errors["truth"] == "filtered" and errors["footprint_texels"] == 6
    assert errors["own"]["mean_absolute"] < 0.5 * errors["hard"]["mean_absolute"]
    assert wide["ratio_to_sm"] > 0 and wide["ratio_to_sm_spread"]["count"] == 2
    assert coarse["ratio_to_sm"] == fine["ratio_to_sm"] == 1, "each is its own reference"
    assert wide["stage_ms"]["resolve"]["count"] == 2 and wide["stage_ratio_to_sm"]["resolve"] > 0


BAD_ROWS = [
    ("[1", ("no JSON", "rows.json")),
    ('{"technique": "sm"}', ("not a list",)),
    ("[3]", ("row 1", "3")),
    ("[{}]", ("row 1", "technique")),
    ('[{"technique": "sm"}, {"technique": "nosuch"}]', ("row 2", "nosuch")),
    ('[{"technique": "sm", "settings": [1]}]', ("row 1", "settings")),
    ('[{"technique": "sm", "settings": {"kernel": 3}}]', ("row 1", "kernel", "sm")),
    ('[{"technique": "sm", "settings": {"map_size": "big"}}]', ("row 1", "map_size")),
    ('[{"technique": "sm", "settings": {"map_size": null}}]', ("row 1", "map_size", "null")),
    ('[{"technique": "sm", "settings": {"map_size": 0}}]', ("row 1", "map_size", "0")),
    ('[{"technique": "sm", "name": 3}]', ("row 1", "name")),
    ('[{"technique": "sm", "colour": "red"}]', ("row 1", "colour")),
    ("[]", ("nothing",)),
]


@pytest.mark.parametrize(("text", "culprits"), BAD_ROWS)
def test_bad_rows_of_a_bench_are_named(run, snapshot, tmp_path, text, culprits):
    (tmp_path / "rows.json").write_text(text, encoding="utf-8")
    assert_fails(run("bench", snapshot, "--rows", "rows.json"), *culprits)


def test_a_bench_says_at_once_what_it_cannot_do(run, snapshot):
    assert_fails(run("bench", snapshot, "--rows", "nowhere.json"), "nowhere.json")
    assert_fails(run("bench", snapshot, "--repeat", 10000, "--json", "/nowhere/bench.json"), "/nowhere/bench.json")


def get_blocked_signals(pid):
    """As bits; the program holds its signals back from the time on when it ends by them in good order."""
    for line in Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines():
        if line.startswith("SigBlk:"):
            return int(line.split()[1], 16)
    return 0


def test_an_interrupted_bench_leaves_no_file(shadowcore, snapshot, tmp_path):
    command = [str(shadowcore), "bench", str(snapshot), "--techniques", "sm", "--repeat", "10000", "--json", "b.json"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE)
    held = 1 << (signal.SIGTERM - 1)
    end = time.monotonic() + 30
    while not get_blocked_signals(process.pid) & held and time.monotonic() < end:
        time.sleep(0.01)
    time.sleep(0.3)
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130 and b"interrupted" in errors
    assert not list(tmp_path.iterdir())


USAGE_ERRORS = [
    ([], "subcommand"),
    (["paint"], "paint"),
    (["render"], "FILE"),
    (["render", "a.npz", "--samples", "0"], "samples"),
    (["render", "a.npz", "--samples", "many"], "samples"),
    (["render", "a.npz", "--resolution", "1280"], "1280x720"),
    (["render", "a.npz", "--resolution", "0x5"], "resolution"),
    (["render", "a.npz", "--map-size", "-1"], "map-size"),
    (["render", "a.npz", "--map-size", "64,128"], "bench"),
    (["render", "a.npz", "--set", "kernel=5"], "TECHNIQUE.PARAMETER=VALUE"),
    (["render", "a.npz", "--set", "pcf.kernel=1,3"], "bench"),
    (["render", "a.npz", "--set", "pcf.kernel="], "no value"),
    (["render", "a.npz", "--techniques", "nosuch"], "nosuch"),
    (["render", "a.npz", "--backend", "metal"], "metal"),
    (["render", "a.npz", "--colour", "red"], "colour"),
    (["bench", "a.npz", "--repeat", "0"], "repeat"),
    (["bench", "a.npz", "--rows", "r.json", "--techniques", "sm"], "--rows"),
    (["bench", "a.npz", "--rows", "r.json", "--map-size", "64"], "--rows"),
    (["render", "a.npz", "--rows", "r.json"], "--rows"),
]


@pytest.mark.parametrize(("arguments", "text"), USAGE_ERRORS)
def test_a_wrong_command_line_returns_2(run, arguments, text):
    done = run(*arguments)
    assert done.returncode == 2 and text in done.stderr + done.stdout


def assert_fails(done, *texts):
    """Exit code 1, one error line that holds the texts, no crash."""
    assert done.returncode == 1, (done.returncode, done.stderr)
    last = done.stderr.strip().splitlines()[-1] if "Tried:" not in done.stderr else done.stderr
    assert "error: " in last
    for text in texts:
        assert str(text) in last, (text, last)


BAD_OPTIONS = [
    (["--lights", "Fill"], ("Fill", "'Key'")),
    (["--techniques", "pcf", "--set", "pcf.kernel=32"], ("kernel",)),
    (["--techniques", "pcf", "--set", "pcf.kernel=big"], ("kernel", "big")),
    (["--techniques", "pcf", "--set", "pcf.bilinear=maybe"], ("bilinear", "maybe")),
    (["--set", "sm.kernel=3"], ("sm", "kernel", "map_size")),
    (["--set", "nosuch.kernel=3"], ("nosuch",)),
    (["--map-size", "1000000"], ("map_size",)),
    (["--techniques", "edsm", "--set", "edsm.softness=-1"], ("softness",)),
    (["--shaders", "/nowhere"], ("/nowhere",)),
    (["--out", "/proc/layers"], ("/proc/layers",)),
    (["--json", "/nowhere/list.json"], ("/nowhere/list.json",)),
    (["--resolution", "1000000x1000000"], ("1000000",)),
]


@pytest.mark.parametrize(("options", "texts"), BAD_OPTIONS)
def test_bad_options_return_1_and_name_the_culprit(run, snapshot, options, texts):
    assert_fails(run("render", snapshot, *options), *texts)


def test_bad_files_return_1_and_are_named(run, tmp_path, snapshot):
    whole = snapshot.read_bytes()
    for name, data in {
        "empty.npz": b"",
        "text.npz": b"not a zip file",
        "cut.npz": whole[: len(whole) // 2],
        "empty.gltf": b"",
        "text.glb": b"glTF but no more",
        "empty.obj": b"# nothing\n",
        "scene.blend": b"BLENDER",
    }.items():
        (tmp_path / name).write_bytes(data)
        assert_fails(run("render", name), name)
        assert_fails(run("bench", name), name)
    assert_fails(run("render", "nowhere.npz"), "nowhere.npz", "no such file")
    assert_fails(run("render", tmp_path), "folder")


def test_scenes_that_cannot_be_rendered_are_named(run, make_snapshot, snapshot_module):
    assert_fails(run("render", make_snapshot(lights=[], jobs=[])), "light")
    sun = snapshot_module.LightData("Broken", "SUN", np.full((4, 4), np.nan))
    with pytest.raises(ValueError):
        json.loads("")  # the reader below is not Python's: NaN is no JSON
    assert_fails(run("render", make_snapshot(lights=[sun], jobs=[])), "snapshot.json")
    flat = snapshot_module.LightData("Flat", "SUN", np.zeros((4, 4)))
    assert_fails(run("render", make_snapshot(lights=[flat], jobs=[])), "Flat")


def test_strange_scenes_are_rendered(run, make_snapshot, snapshot_module, tmp_path):
    """Vertices that are not finite, faces without area, nothing to see: a picture, and what was dropped is said."""
    positions = small_scene.BOX.copy()
    positions[0] = np.nan
    positions[1] = np.inf
    flat = np.zeros((3, 3), np.float32)
    meshes = [
        snapshot_module.MeshData("ground", small_scene.GROUND, small_scene.GROUND_TRIANGLES),
        snapshot_module.MeshData("box", positions, small_scene.BOX_TRIANGLES),
    ]
    done = run("render", make_snapshot(meshes=meshes), "--out", "a")
    assert done.returncode == 0 and "box" in done.stderr
    meshes[1] = snapshot_module.MeshData("flat", flat, np.array([[0, 1, 2]], np.uint32))
    assert run("render", make_snapshot(meshes=meshes), "--out", "b").returncode == 0
    mask = read_png(tmp_path / "b" / "Key_sm.png")
    assert mask.min() == 255
    meshes[:] = []
    empty = {
        "meshes": [],
        "instance_mesh": np.zeros(0, np.uint32),
        "instance_matrix": np.zeros((0, 4, 4)),
        "instance_flags": np.zeros(0, np.uint32),
        "instance_receiver_group": np.zeros(0, np.uint8),
        "instance_blocker_group": np.zeros(0, np.uint8),
    }
    assert run("render", make_snapshot(**empty), "--out", "c").returncode == 0
    assert read_png(tmp_path / "c" / "Key_sm.png").min() == 255


@pytest.mark.parametrize("backend", ["auto", "osmesa", "egl"])
def test_without_gl_it_says_what_to_install(run, snapshot, tmp_path, backend):
    for name in ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so", "libEGL.so.1", "libEGL.so"):
        (tmp_path / name).write_text("no library")
    done = run("render", snapshot, "--backend", backend, env={"LD_LIBRARY_PATH": str(tmp_path)})
    assert done.returncode == 1 and "error: no OpenGL" in done.stderr and "install" in done.stderr
    assert ("OSMesa" in done.stderr) == (backend != "egl") and ("EGL" in done.stderr) == (backend != "osmesa")


def test_500_lights_are_written_one_by_one(run, make_snapshot, snapshot_module, tmp_path):
    lights = [snapshot_module.LightData("Same", "SUN", small_scene.looking_down(5.0)) for _ in range(500)]
    snapshot = make_snapshot(lights=lights, jobs=[snapshot_module.Job(k, "sm", {"map_size": 64}) for k in range(500)])
    done = run("render", snapshot, "--resolution", "16x12", "--out", "o")
    assert done.returncode == 0, done.stderr
    layers = json.loads((tmp_path / "o" / "render.json").read_text(encoding="utf-8"))["layers"]
    assert len({layer["channel"] for layer in layers}) == len({layer["picture"] for layer in layers}) == 500


def test_the_shader_folder_is_looked_for(run, root, snapshot, tmp_path):
    copy = tmp_path / "my shaders"
    shutil.copytree(root / "shaders", copy)
    assert run("render", snapshot, "--out", "a", env={"SHADOW_LAYERS_SHADERS": str(copy)}).returncode == 0
    assert_fails(
        run("render", snapshot, env={"SHADOW_LAYERS_SHADERS": "/nowhere"}), "SHADOW_LAYERS_SHADERS", "/nowhere"
    )
    assert (
        run("render", snapshot, "--shaders", copy, "--out", "b", env={"SHADOW_LAYERS_SHADERS": "/nowhere"}).returncode
        == 0
    )
    for path in copy.rglob("*"):
        if path.is_file():
            path.write_text("#error broken on purpose\n")
    assert_fails(run("render", snapshot, "--shaders", copy), ".")


@pytest.mark.parametrize("room", [0, 1000, 6000])
def test_a_full_disk_leaves_no_half_file(run, snapshot, tmp_path, room):
    """A limit on file sizes stands in for the full disk."""

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

    done = run("render", snapshot, "--resolution", "640x480", "--samples", 4, "--out", "o", preexec_fn=limit)
    assert done.returncode == 1 and "cannot be written" in done.stderr
    assert not (tmp_path / "o" / "layers.exr").exists() and not (tmp_path / "o" / "render.json").exists()
    assert not list((tmp_path / "o").glob(".*")), "temporary files are removed"


@pytest.mark.parametrize("kind", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_it_leaves_no_half_file(shadowcore, snapshot, tmp_path, kind):
    command = [str(shadowcore), "render", str(snapshot), "--resolution", "1600x1200", "--samples", "64", "--out", "o"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE)
    end = time.monotonic() + 30
    while not list(tmp_path.glob("o/.shadow-layers-*layers.exr")) and time.monotonic() < end:
        time.sleep(0.01)
    time.sleep(0.2)
    process.send_signal(kind)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130 and b"interrupted" in errors
    assert not (tmp_path / "o" / "layers.exr").exists() and not list((tmp_path / "o").glob(".*"))
