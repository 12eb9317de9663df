# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line in every Blender: what it writes, and what it says when it can't."""

import json
import math
import os
import resource
import shutil
import signal
import subprocess
import time
import zlib
from pathlib import Path

import bpy
import numpy as np
import pytest
from conftest import blender_command

SIZE = (64, 36)


def add(name, data, location, rotation=(0, 0, 0), scene=None):
    made = bpy.data.objects.new(name, data)
    (scene or bpy.context.scene).collection.objects.link(made)
    made.location, made.rotation_euler = location, rotation
    return made


def add_mesh(name, corners):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [range(len(corners))])
    return add(name, mesh, (0, 0, 0))


@pytest.fixture(scope="module")
def blend(addon, tmp_path_factory) -> Path:
    """Ground, a moving card, a sun, two lamps with shared data, two cameras (one bound to a marker), two scenes."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.name = "Shot"
    add_mesh("Ground", [(-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0)])
    card = add_mesh("Card", [(-1, -1, 1.5), (1, -1, 1.5), (1, 1, 1.5), (-1, 1, 1.5)])
    for frame, x in ((1, -1.0), (3, 1.0)):
        card.location.x = x
        card.keyframe_insert("location", frame=frame)
    add("Sun", bpy.data.lights.new("Sun", "SUN"), (0, 0, 4), (0.5, 0.3, 0))
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy = 500
    add("Lamp.A", lamp, (2, 2, 5))
    add("Lamp.B", lamp, (-2, 2, 5))
    for name, x in (("Camera", 0.0), ("Other", 3.0)):
        camera = bpy.data.cameras.new(name)
        camera.angle = math.radians(50)
        add(name, camera, (x, 0, 12))
    scene.camera = bpy.data.objects["Camera"]
    scene.timeline_markers.new("cut", frame=1).camera = scene.camera
    scene.render.resolution_x, scene.render.resolution_y = 128, 72
    scene.render.resolution_percentage = 50
    scene.frame_set(1)
    bpy.data.scenes.new("Empty")
    scene.view_layers.new("Spare").use = False
    scene.render.engine = "SHADOW_LAYERS"
    path = tmp_path_factory.mktemp("batch") / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def run_here(module, blend):
    """run_here("render", "--out", ...): the batch in this process; its exit code."""

    def run(*arguments, file=blend):
        options = module("batch_options").parse_arguments([str(file), *(str(argument) for argument in arguments)])
        return module("batch_run").run(options)

    return run


def read_json(path):
    return json.loads(Path(path).read_text(encoding="utf-8"))


def check_all_files(folder, document, lists):
    for name in {
        r[key] for part in lists for r in document[part] for key in r if key == "file" or key.endswith("picture")
    }:
        assert (folder / name).stat().st_size > 0, name
    assert not list(folder.glob(".*"))  # nothing temporary is left


# ---- render


def test_render_writes_every_layer(run_here, module, tmp_path, capfd):
    out = tmp_path / "new" / "folder"
    assert run_here("render", "--techniques", "sm,pcf", "--frames", "1..2", "--out", out, "--set", "pcf.kernel=5",
                    "--map-size", 128, "--samples", 2) == 0  # fmt: skip
    document = read_json(out / "render.json")
    assert (document["schema"], document["schema_version"]) == ("shadow-layers-render", 1)
    assert document["blender"] == bpy.app.version_string and document["gl_renderer"] and document["revision"]
    layers = document["layers"]
    wanted = {(light, technique, frame) for light in ("Sun", "Lamp.A", "Lamp.B") for technique in ("sm", "pcf")
              for frame in (1, 2)}  # fmt: skip
    assert {(r["light"], r["technique"], r["frame"]) for r in layers} == wanted and len(layers) == len(wanted)
    for record in layers:
        assert record["settings"]["map_size"] == 128
        assert record["technique"] != "pcf" or record["settings"]["kernel"] == 5
        assert record["time_ms"] and all(time["cpu"] >= 0 for time in record["time_ms"].values())
        header = module("exr_check").check_exr(out / record["file"])
        assert record["channel"] in header.channels and header.size == SIZE
    assert [f["frame"] for f in document["frames"]] == [1, 2] and document["frames"][0]["samples"] == 2
    assert document["frames"][0]["coverage_channel"] in header.channels
    assert len({r["picture"] for r in layers}) == len(layers)
    check_all_files(out, document, ("frames", "layers"))
    assert "[2/2] frame 2: rendering" in capfd.readouterr().out


def read_grey_png(path):
    data = path.read_bytes()
    width, height = int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
    start = data.index(b"IDAT") + 4
    rows = np.frombuffer(zlib.decompress(data[start:]), np.uint8).reshape(height, width + 1)[:, 1:]
    return np.cumsum(rows, axis=0, dtype=np.uint8)[::-1]  # each row holds its difference to the one above


def test_pictures_show_the_shadow_where_it_is(run_here, tmp_path):
    """The card's shadow under the lamps, in closed form, in the PNG of each lamp."""
    out = tmp_path / "o"
    assert run_here("render", "--techniques", "edsm", "--lights", "Lamp.A", "Lamp.B", "--samples", 1, "--frames", 3,
                    "--resolution", "320x180", "--out", out) == 0  # fmt: skip
    records = {r["light"]: r for r in read_json(out / "render.json")["layers"]}
    assert set(records) == {"Lamp.A", "Lamp.B"}
    half = 12 * math.tan(math.radians(25))
    rows, columns = np.mgrid[0:180, 0:320]
    x, y = (columns + 0.5 - 160) / 160 * half, (rows + 0.5 - 90) / 160 * half
    for name, (light_x, light_y) in (("Lamp.A", (2, 2)), ("Lamp.B", (-2, 2))):
        grow = 5 / (5 - 1.5)
        left, right = (light_x + (edge - light_x) * grow for edge in (0, 2))  # the card is at x = 1 in frame 3
        low, high = (light_y + (edge - light_y) * grow for edge in (-1, 1))
        inside = np.minimum(np.minimum(x - left, right - x), np.minimum(y - low, high - y))
        behind_card = (np.abs(x - 8 / 7) < 9 / 7) & (np.abs(y) < 9 / 7)  # the camera sees the card there
        certain = (np.abs(inside) > 0.05) & ~behind_card
        picture = read_grey_png(out / records[name]["picture"])
        assert np.array_equal(picture[certain] > 127, (inside < 0)[certain]), name
        assert (picture[certain] < 128).sum() > 300


def test_choices_reach_the_render(run_here, tmp_path):
    out = tmp_path / "o"
    assert run_here("render", "--scene", "Shot", "--view-layer", "Spare", "--camera", "Other", "--resolution", "40x30",
                    "--techniques", "sm", "--lights", "Lamp.B", "--out", out,
                    "--json", tmp_path / "list" / "j.json") == 0  # fmt: skip
    document = read_json(tmp_path / "list" / "j.json")
    assert document["camera"] == "Other" and document["frames"][0]["resolution"] == [40, 30]
    assert [(r["light"], r["view_layer"]) for r in document["layers"]] == [("Lamp.B", "Spare")]
    assert bpy.data.scenes["Shot"].camera.name == "Other"  # the marker's camera didn't win
    assert document["layers"][0]["channel"].startswith("Spare.")


def test_skip_existing_renders_only_what_is_missing(run_here, tmp_path, capfd):
    out = tmp_path / "o"
    common = ("render", "--techniques", "sm", "--frames", "1..2", "--lights", "Sun", "--out", out, "--skip-existing")
    assert run_here(*common) == 0
    times = {path.name: path.stat().st_mtime_ns for path in out.iterdir() if path.suffix != ".json"}
    before = read_json(out / "render.json")
    capfd.readouterr()
    assert run_here(*common) == 0
    said = capfd.readouterr().out
    assert said.count("is there already") == 2 and "rendering" not in said
    assert {path.name: path.stat().st_mtime_ns for path in out.iterdir() if path.suffix != ".json"} == times
    assert read_json(out / "render.json")["layers"] == before["layers"]
    (out / before["layers"][1]["picture"]).unlink()
    assert run_here(*common) == 0
    said = capfd.readouterr().out
    assert "frame 1: is there already" in said and "frame 2: rendering" in said
    assert run_here(*common, "--map-size", 64) == 0
    assert capfd.readouterr().out.count("is there already") == 0


def test_folder_with_an_odd_name(run_here, tmp_path, monkeypatch):
    """Blender counts frames with #, and since 4.5 takes words in braces for variables."""
    out = tmp_path / "a #1 {take} é"
    assert run_here("render", "--techniques", "sm", "--lights", "Sun", "--out", out) == 0
    check_all_files(out, read_json(out / "render.json"), ("frames", "layers"))
    monkeypatch.setattr("tempfile.tempdir", str(out))  # where the truth is rendered
    assert run_here("compare", "--techniques", "sm", "--lights", "Sun", "--out", out, "--no-cache") == 0


def test_same_frame_twice_is_the_same(run_here, tmp_path):
    for name in "ab":
        assert run_here("render", "--techniques", "edsm", "--lights", "Lamp.A", "--out", tmp_path / name) == 0
    pictures = [(tmp_path / name / "Lamp_A_edsm.png").read_bytes() for name in "ab"]
    assert pictures[0] == pictures[1]


def test_skip_existing_tells_cameras_and_borders_apart(run_here, module, blend, tmp_path, capfd):
    common = ("render", "--techniques", "sm", "--lights", "Sun", "--out", tmp_path / "o", "--skip-existing")
    assert run_here(*common, "--camera", "Camera") == 0
    assert run_here(*common, "--camera", "Other") == 0
    assert "is there already" not in capfd.readouterr().out
    bpy.context.scene.render.use_border = True
    bpy.context.scene.render.border_max_x = 0.5
    bordered = blend.with_name("bordered") / blend.name
    bordered.parent.mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(bordered), copy=True)
    assert run_here(*common, "--camera", "Other", file=bordered) == 0
    assert "is there already" not in capfd.readouterr().out
    record = read_json(tmp_path / "o" / "render.json")["frames"][0]
    assert (record["region"], record["resolution"], record["camera"]) == ([0, 0, 32, 36], [64, 36], "Other")


def test_frames_of_long_names_do_not_overwrite_each_other(run_here, tmp_path, blend):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.data.objects["Sun"].name = "A very long name of a light that fills all that Blender allows"
    for layer, name in zip(bpy.context.scene.view_layers, "AB", strict=True):
        layer.name, layer.use = name * 24, True
    path = tmp_path / "long.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    out = tmp_path / "o"
    assert run_here("render", "--techniques", "sm", "--frames", "1..2", "--out", out, file=path) == 0
    layers = read_json(out / "render.json")["layers"]
    assert len({record["picture"] for record in layers}) == len(layers) == 12
    check_all_files(out, read_json(out / "render.json"), ("frames", "layers"))


def test_light_that_is_instanced_too_has_no_truth(run_here, tmp_path, capfd, blend):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    group = bpy.data.collections.new("Group")
    group.objects.link(bpy.data.objects["Sun"])
    holder = add("Holder", None, (0, 0, 4), scene=bpy.context.scene)
    holder.instance_type, holder.instance_collection = "COLLECTION", group
    path = tmp_path / "both.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    common = ("compare", "--techniques", "sm", "--no-cache", "--out", tmp_path / "o", "--lights")
    assert run_here(*common, "Sun", file=path) == 1
    assert '"Sun" is instanced too' in capfd.readouterr().err
    assert run_here(*common, "Lamp.A", file=path) == 0


def test_long_view_layer_is_named_where_blender_cuts_channels(run_here, tmp_path, capfd, blend):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.context.scene.view_layers["ViewLayer"].name = "L" * 60
    path = tmp_path / "long.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    code = run_here("render", "--techniques", "sm", "--lights", "Sun", "--out", tmp_path / "o", file=path)
    if bpy.app.version >= (5, 0, 0):
        assert code == 0
    else:
        assert code == 1 and "give the view layer a shorter name" in capfd.readouterr().err
        assert not (tmp_path / "o" / "layers.exr").exists()


def test_instanced_and_linked_lights_can_be_chosen(run_here, tmp_path, capfd, blend):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    scene = bpy.context.scene
    group = bpy.data.collections.new("Group")
    lamp = bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", "POINT"))
    group.objects.link(lamp)
    holder = add("Holder", None, (0, 0, 4), scene=scene)
    holder.instance_type, holder.instance_collection = "COLLECTION", group
    far = add("Far", bpy.data.lights.new("Far", "POINT"), (1, 1, 5), scene=scene)
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {far})
    bpy.data.objects.remove(far)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["Far"]
    scene.collection.objects.link(wanted.objects[0])
    path = tmp_path / "chosen.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    common = ("--techniques", "sm", "--lights")
    out = tmp_path / "o"
    assert run_here("render", "--out", out, *common, "Bulb", "Far [library.blend]", file=path) == 0
    lights = [record["light"] for record in read_json(out / "render.json")["layers"]]
    assert sorted(lights) == ["Bulb @Holder", "Far [library.blend]"]
    assert run_here("compare", "--no-cache", "--out", tmp_path / "c", *common, "Far [library.blend]", file=path) == 0
    assert read_json(tmp_path / "c" / "comparison.json")["records"][0]["pixel_count"] > 500
    library.unlink()
    capfd.readouterr()
    assert run_here("render", "--out", out, *common, "Sun", file=path) == 0  # what is there can be rendered
    assert run_here("render", "--out", out, *common, "Far [library.blend]", file=path) == 1
    assert 'no light "Far [library.blend]" to render' in capfd.readouterr().err


# ---- snapshot and info


def test_snapshot_can_be_loaded(run_here, module, tmp_path):
    out = tmp_path / "o"
    assert run_here("snapshot", "--out", out, "--json", out / "s.json", "--techniques", "sm", "--lights", "Sun") == 0
    snapshot = module("snapshot").SceneSnapshot.load(out / "snapshot.npz")
    assert snapshot.triangle_count == 4 and (snapshot.render.width, snapshot.render.height) == SIZE
    assert {light.name for light in snapshot.lights} >= {"Sun"}
    assert [(snapshot.lights[job.light].name, job.technique) for job in snapshot.jobs] == [("Sun", "sm")]
    assert read_json(out / "s.json")["snapshots"][0]["triangles"] == 4


def test_info_tells_versions_and_techniques(run_here, module, tmp_path, capfd):
    path = tmp_path / "info.json"
    assert run_here("info", "--json", path) == 0
    said, info = capfd.readouterr().out, read_json(path)
    assert info["schema"] == "shadow-layers-info" and info["blender"] == bpy.app.version_string
    ids = [technique["id"] for technique in info["techniques"]]
    assert ids == [t["id"] for t in module("bridge").techniques()] and "sm" in ids
    for word in (info["gl_renderer"], info["revision"], str(info["max_texture_size"]), "map_size", *ids):
        assert word in said


# ---- what goes wrong


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--scene", "Nope"], r'no scene "Nope"; the file has "Empty", "Shot"'),
        (["--view-layer", "Nope"], r'"Shot" has no view layer "Nope"; it has "ViewLayer", "Spare"'),
        (["--camera", "Nope"], r'no camera "Nope"; its cameras are "Camera", "Other"'),
        (["--camera", "Sun"], r'no camera "Sun"; its cameras are'),
        (["--lights", "Nope"], r'no light "Nope" to render; there are "Lamp.A", "Lamp.B", "Sun"'),
        (["--lights", "Sun", "Ground"], r'no light "Ground"'),
        (["--techniques", "sm,nope"], r'no technique "nope"; the techniques are: sm'),
        (["--techniques", "probe"], r'technique "probe" is for tests only'),
        (["--set", "nope.kernel=3"], r'no technique "nope"'),
        (["--set", "pcf.nope=3"], r'technique "pcf" has no parameter "nope"; it has map_size, kernel'),
        (["--set", "pcf.kernel=many"], r'pcf.kernel is a whole number, not "many"'),
        (["--set", "pcf.kernel=1000"], r"kernel"),
        (["--set", "pcf.bilinear=maybe"], r'pcf.bilinear is on or off, not "maybe"'),
        (["--set", "edsm.reading=mine"], r"edsm.reading is one of improved, thesis"),
        (["--map-size", "1000000"], r"map_size"),
        (["--scene", "Empty"], r'scene "Empty" has no camera: choose one in its properties, or give --camera'),
    ],
)  # fmt: skip
def test_errors_name_culprit_and_remedy(run_here, tmp_path, capfd, arguments, message):
    out = tmp_path / "o"
    assert run_here("render", "--out", out, *arguments) == 1
    last = capfd.readouterr().err.strip().splitlines()[-1]
    assert last.startswith("error: ") and message in last
    assert not out.exists() or not list(out.iterdir())


def test_file_that_is_not_there(run_here, tmp_path, capfd):
    assert run_here("render", file=tmp_path / "none.blend") == 1
    assert 'there is no file "' in capfd.readouterr().err
    (tmp_path / "text.blend").write_text("no blend file")
    assert run_here("render", file=tmp_path / "text.blend") == 1
    assert "can not be opened" in capfd.readouterr().err


def test_folder_that_can_not_be_written(run_here, tmp_path, capfd):
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", Path("/proc/nothing/here")):
        for verb in ("render", "compare", "snapshot"):
            assert run_here(verb, "--techniques", "sm", "--out", out) == 1
            said = capfd.readouterr().err
            assert f'the output folder "{out}" can not be written to' in said and "--out" in said


def test_technique_that_serves_none_of_the_lights_or_no_lights(run_here, tmp_path, capfd, blend):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    for thing in [thing for thing in bpy.data.objects if thing.type == "LIGHT"]:
        bpy.data.objects.remove(thing)
    dark = tmp_path / "dark.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(dark))
    assert run_here("render", "--out", tmp_path / "o", file=dark) == 1
    assert "light" in capfd.readouterr().err
    bpy.context.scene.view_layers["Spare"].use = True  # of several view layers each may be without light, but not all
    bpy.ops.wm.save_as_mainfile(filepath=str(dark))
    assert run_here("render", "--out", tmp_path / "o", file=dark) == 1
    said = capfd.readouterr().err
    assert "no view layer has a shadow layer" in said and "has no light; add a sun" in said
    assert not list((tmp_path / "o").iterdir())


# ---- in a process of its own, as users run it


def test_process_writes_and_tells(run_batch, blend, tmp_path):
    out = tmp_path / "o"
    done = run_batch(blend, "render", "--techniques", "sm", "--lights", "Sun", "--out", out)
    assert (out / "layers.exr").is_file() and (out / "Sun_sm.png").is_file() and (out / "combined.png").is_file()
    assert "Fra:" not in done.stdout and "1 layers are in" in done.stdout
    failed = run_batch(blend, "render", "--lights", "Nope", "--out", out, check=False)
    assert failed.returncode == 1 and failed.stderr.strip().splitlines()[-1].startswith("error: ")
    assert run_batch(blend, "rendr", check=False).returncode == 2
    assert run_batch(blend, "--help").stdout.startswith("usage") or "usage:" in run_batch(blend, "--help").stdout


def start(blend, project_root, native_module_dir, *arguments, **options):
    command = blender_command(project_root / "addon" / "batch.py", [str(a) for a in arguments], blend)
    environment = {**os.environ, "SHADOW_LAYERS_MODULE_DIR": str(native_module_dir)}
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, **options
    )


def test_full_disk_is_told_and_leaves_no_half_file(blend, project_root, native_module_dir, tmp_path):
    """A limit on the size of files makes writing fail half way, as a full disk does; Blender itself reports success."""
    limit = 100_000

    def limit_file_size():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

    out = tmp_path / "o"
    process = start(
        blend, project_root, native_module_dir, "render", "--techniques", "sm,pcf", "--resolution", "640x360",
        "--out", out, preexec_fn=limit_file_size,
    )  # fmt: skip
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 1, errors
    last = errors.strip().splitlines()[-1]
    assert last.startswith("error: ") and "layers.exr" in last and "--out" in last
    assert not (out / "layers.exr").exists() and not list(out.glob(".*"))


def test_killed_run_leaves_no_half_file_under_a_final_name(blend, project_root, native_module_dir, module, tmp_path):
    out = tmp_path / "o"
    process = start(
        blend, project_root, native_module_dir, "render", "--techniques", "sm", "--frames", "1..500", "--out", out,
        "--resolution", "640x360",
    )  # fmt: skip
    try:
        deadline = time.monotonic() + 60
        while not (out / "layers_0002.exr").exists() and time.monotonic() < deadline and process.poll() is None:
            time.sleep(0.02)
    finally:
        process.kill()
        process.communicate(timeout=60)
    assert (out / "layers_0002.exr").exists()
    final = [path for path in out.iterdir() if not path.name.startswith(".")]
    for path in final:
        if path.suffix == ".exr":
            assert module("exr_check").check_exr(path).size == (640, 360)
        elif path.suffix == ".png":
            assert path.read_bytes().endswith(b"IEND\xaeB`\x82")
        else:
            read_json(path)


@pytest.mark.parametrize("cut", [1, 100, 5_000])
def test_cut_off_exr_is_found(run_here, module, tmp_path, cut):
    out = tmp_path / "o"
    assert run_here("render", "--techniques", "sm", "--lights", "Sun", "--out", out) == 0
    check = module("exr_check")
    whole = (out / "layers.exr").read_bytes()
    broken = tmp_path / "broken.exr"
    broken.write_bytes(whole[:-cut])
    with pytest.raises(check.ExrError, match=r"end is missing|cut off"):
        check.check_exr(broken)
    for rest in (b"", whole[:3], whole[:200]):
        broken.write_bytes(rest)
        with pytest.raises(check.ExrError, match="cut off"):
            check.check_exr(broken)
    broken.write_bytes(b"no picture at all")
    with pytest.raises(check.ExrError, match="no EXR"):
        check.check_exr(broken)
    shutil.copy(out / "layers.exr", broken)
    assert check.check_exr(broken).size == SIZE
