# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch's command line and files, without Blender."""

import errno
import importlib
import json
import os
import stat
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

files = importlib.import_module("addon.batch_files")
options = importlib.import_module("addon.batch_options")
done = importlib.import_module("addon.batch_done")
cache = importlib.import_module("addon.truth_cache")


def parse(*arguments):
    return options.parse_arguments(list(arguments))


def run_script(*arguments):
    return subprocess.run(
        [sys.executable, ROOT / "addon" / "batch.py", *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


# ---- options


def test_options_of_a_temporal_comparison():
    got = parse("a.blend", "compare", "--temporal", "light", "--temporal-frames", "5", "--temporal-step", "0.25")
    assert (got.temporal, got.temporal_frames, got.temporal_step, got.border_samples) == ("light", 5, 0.25, 3)
    assert parse("compare").temporal is None and parse("compare").temporal_step is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--temporal", "sideways"), "sideways"),
        (("--temporal-frames", "1"), '"1" is no whole number from 2 to 1000'),
        (("--temporal-step", "0"), '"0" is no step: write degrees'),
        (("--temporal-step", "nan"), '"nan" is no step: write degrees'),
        (("--temporal-step", "1e9"), "is no step: write degrees"),
        (("--border-samples", "0"), '"0" is no whole number from 1 to 16'),
        (("--truth", "named,firm"), '"named,firm" is no truth: write named, hard, filtered, soft'),
        (("--truth", ","), '"," is no truth'),
        (("--truth-samples", "3"), '"3" is no whole number from 4 to 65536'),
    ],
)
def test_bad_options_of_measures_are_refused(arguments, message, capsys):
    with pytest.raises(SystemExit) as stop:
        parse("compare", *arguments)
    assert stop.value.code == 2 and message in capsys.readouterr().err


def test_truths_of_a_comparison():
    got = parse("compare", "--truth", "soft, named,soft", "--truth-samples", "256")
    assert (got.truth, got.truth_samples) == (["soft", "named"], 256)
    assert (parse("compare").truth, parse("compare").truth_samples) == (["named"], 64)
    every = ["hard", "filtered", "soft", "pixel"]
    assert parse("compare", "--truth", ",".join(every)).truth == every


def test_all_options_of_a_render():
    got = parse(
        "shot.blend", "render", "--techniques", "sm,edsm", "--lights", "Key", "Fill 2", "--resolution",
        "1280x720",
        "--map-size", "2048", "--frames", "3..12", "--scene", "S", "--view-layer", "V", "--camera", "C",
        "--samples", "16",
        "--threads", "2", "--skip-existing", "--out", "o", "--json", "j.json", "--set", "pcf.kernel=5",
        "--set", "edsm.softness=0.5",
    )  # fmt: skip
    assert (got.file, got.verb, got.techniques) == (Path("shot.blend"), "render", ["sm", "edsm"])
    assert got.lights == ["Key", "Fill 2"] and got.resolution == (1280, 720) and got.map_size == 2048
    assert list(got.frames) == list(range(3, 13)) and got.samples == 16 and got.threads == 2 and got.skip_existing
    assert (got.scene, got.view_layer, got.camera) == ("S", "V", "C")
    assert (got.out, got.json) == (Path("o"), Path("j.json"))
    assert got.settings == [("pcf", "kernel", "5"), ("edsm", "softness", "0.5")]


def test_defaults_leave_the_file_as_it_is():
    got = parse("render")
    assert got.file is None and got.frames is None and got.settings == []
    for name in (
        "scene",
        "view_layer",
        "camera",
        "lights",
        "techniques",
        "map_size",
        "samples",
        "resolution",
        "threads",
    ):
        assert getattr(got, name) is None


def test_one_frame_and_negative_frames():
    assert list(parse("render", "--frames", "7").frames) == [7]
    assert list(parse("render", "--frames=-2..1").frames) == [-2, -1, 0, 1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["render", "--frames", "5..1"], "runs backwards: write 1..5"),
        (["render", "--frames", "1-5"], "write A..B"),
        (["render", "--resolution", "1280"], "write WxH"),
        (["render", "--resolution", "0x720"], "write WxH"),
        (["render", "--techniques", ","], "no technique is named"),
        (["render", "--set", "kernel=5"], r"TECHNIQUE.PARAMETER=VALUE"),
        (["render", "--samples", "65"], "from 1 to 64"),
        (["render", "--samples", "two"], "from 1 to 64"),
        (["render", "--threads", "0"], "from 1 to 256"),
        (["render", "--backend", "vulkan"], "invalid choice: 'vulkan'"),
        (["render", "--lights"], "--lights"),
        (["rendr"], '"rendr" is neither a verb (render, compare, snapshot, info) nor a .blend file'),
        (["--nonsense"], "VERB"),
        (["shot.blend"], "VERB"),
        (["shot.blend", "render", "--nonsense"], "--nonsense"),
        ([], "VERB"),
    ],
)
def test_mistakes_name_the_culprit(capsys, arguments, message):
    with pytest.raises(SystemExit) as stop:
        options.parse_arguments(arguments)
    assert stop.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ") and message in said and said.count("\n") == 1


def test_help_tells_all_without_blender():
    done_run = run_script("--help")
    assert done_run.returncode == 0
    for word in ("--techniques", "--lights", "--resolution", "--map-size", "--frames", "--scene", "--view-layer",
                 "--camera",
                 "--samples", "--threads", "--skip-existing", "--out", "--json", "--set", "Exit code", "blender -b",
                 *options.VERBS):  # fmt: skip
        assert word in done_run.stdout


def test_script_ends_with_the_code_of_the_mistake():
    done_run = run_script("render", "--samples", "0")
    assert done_run.returncode == 2 and done_run.stderr.startswith("error: argument --samples")


def test_without_bpy_the_remedy_is_named():
    done_run = subprocess.run(
        [sys.executable, "-c", "import sys; sys.modules['bpy'] = None; import runpy; sys.argv = ['batch.py', 'info'];"
         f"runpy.run_path({str(ROOT / 'addon' / 'batch.py')!r}, run_name='__main__')"],
        capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert done_run.returncode == 1
    assert "pip install bpy" in done_run.stderr and "blender -b" in done_run.stderr


# ---- files


def test_files_appear_whole_or_not_at_all(tmp_path):
    target = tmp_path / "a.json"
    with pytest.raises(RuntimeError), files.whole_file(target) as temporary:
        temporary.write_text("half")
        assert not target.exists()
        raise RuntimeError("stop")
    assert list(tmp_path.iterdir()) == []
    files.write_json(target, {"a": [1, None]})
    assert json.loads(target.read_text()) == {"a": [1, None]}
    assert list(tmp_path.iterdir()) == [target]
    umask = os.umask(0)
    os.umask(umask)
    assert stat.S_IMODE(target.stat().st_mode) == 0o666 & ~umask


def test_old_file_stays_until_the_new_one_is_whole(tmp_path):
    target = tmp_path / "a.txt"
    target.write_text("old")
    with pytest.raises(files.BatchError, match="nothing was written"), files.whole_file(target):
        assert target.read_text() == "old"
    assert target.read_text() == "old"


def test_not_a_number_is_no_json(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        files.write_json(tmp_path / "a.json", {"a": float("nan")})
    assert list(tmp_path.iterdir()) == []


def test_full_disk_is_named(tmp_path):
    with pytest.raises(files.BatchError, match=r"No space left.*--out"), files.whole_file(tmp_path / "a.png"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert list(tmp_path.iterdir()) == []


def test_folder_that_is_a_file_is_named(tmp_path):
    (tmp_path / "f").write_text("")
    with pytest.raises(files.BatchError, match=r'"[^"]*f/sub" can not be written to.*--out'):
        files.make_output_folder(tmp_path / "f" / "sub")


def test_leftovers_of_a_killed_run_go_after_a_day(tmp_path):
    fresh, stale = (tmp_path / f"{files.TEMPORARY_PREFIX}{name}.exr" for name in ("fresh", "stale"))
    for path in (fresh, stale):
        path.write_text("half")
    old = time.time() - 2 * files.STALE_S
    os.utime(stale, (old, old))
    files.make_output_folder(tmp_path)
    assert fresh.exists() and not stale.exists()


def test_file_names_are_safe_and_unique():
    namer = files.FileNamer()
    names = [
        namer.make_name(light, "sm") for light in ("Key", "key", "Key.001", "Key_001", "a/b", "a:b", "", "☀" * 100)
    ]
    assert len({name.casefold() for name in names}) == len(names)
    assert names[0] == "Key_sm" and names[2] == "Key_001_sm"
    for name in names:
        assert not set(name) & set(files.FORBIDDEN_IN_FILE_NAMES + ".") and len(name.encode()) < 120
    assert namer.make_name("Key.001", "sm") == names[2]


def test_names_that_are_cut_stay_apart_whoever_else_is_named():
    """A frame's files are named without knowledge of the other frames' files."""
    names = {files.FileNamer().make_name("Layer" * 12, "Light" * 12, technique) for technique in ("sm", "pcf", "edsm")}
    assert len(names) == 3 and all(len(name) <= files.FILE_NAME_BYTES for name in names)


def test_frames_before_zero(tmp_path):
    for words, frames in ((["--frames", "-5..5"], range(-5, 6)), (["--frames", "-3"], range(-3, -2))):
        assert options.parse_arguments(["render", *words, "--out", str(tmp_path)]).frames == frames


def test_progress_beats_while_a_step_lasts(tmp_path):
    script = (
        "import importlib, sys, time, os; sys.path.insert(0, sys.argv[1]);"
        "files = importlib.import_module('addon.batch_files'); files.HEARTBEAT_S = 0.05; p = files.Progress()\n"
        "with p.step('working'):\n print('chatter', flush=True); time.sleep(0.3)\n"
        "try:\n with p.step('failing'):\n  print('reason', flush=True); raise KeyError\n"
        "except KeyError: pass\n"
    )
    got = subprocess.run(
        [sys.executable, "-c", script, ROOT], capture_output=True, text=True, check=True, timeout=60
    ).stdout
    assert got.startswith("working\n") and "  ... 0 s: working" in got
    assert "chatter" not in got and "reason" in got.split("failing")[1]


# ---- skipping what is there


def test_frames_that_are_there_are_found(tmp_path):
    settings = {"map_size": 1024, "bias": 0.1, "bilinear": True}
    document = {
        "schema": "s", "schema_version": 1, "file": "shot.blend", "scene": "Scene", "camera": "Main",
        "frames": [{"frame": 4, "resolution": [64, 36], "region": [0, 0, 64, 36], "samples": 1,
                    "file": "layers_0004.exr"}],
        "layers": [{"frame": 4, "view_layer": "V", "light": "Key", "technique": "sm", "settings": settings,
                    "picture": "Key_sm.png"}],
    }  # fmt: skip
    path = tmp_path / "render.json"
    path.write_text(json.dumps(document))

    def find(frame=4, resolution=(64, 36), region=(0, 0, 64, 36), samples=1, head=None, **changes):
        wanted = done.Wanted(list(resolution), list(region), samples, [("V", "Key", "sm", {**settings, **changes})])
        return done.DoneBefore(path, tmp_path, {**document, **(head or {})}).find(frame, wanted, "layers")

    assert find() is None  # the files are missing
    for name in ("layers_0004.exr", "Key_sm.png"):
        (tmp_path / name).write_text("x")
    assert find() == (document["frames"], document["layers"])
    assert find(bias=np.float32(0.1).item()) is not None
    assert find(frame=5) is None and find(resolution=(64, 37)) is None and find(samples=2) is None
    assert find(map_size=512) is None and find(bilinear=False) is None and find(region=(8, 8, 9, 9)) is None
    for other in ({"schema_version": 2}, {"file": "b.blend"}, {"scene": "Other"}, {"camera": "Side"}):
        assert find(head=other) is None, other
    path.write_text("{broken")
    assert find() is None


# ---- the truth's cache


def test_cache_returns_what_was_stored(tmp_path):
    store = cache.TruthCache(tmp_path / "deep" / "folder")
    arrays = {"a": np.arange(6, dtype=np.float32).reshape(2, 3), "b": np.array([True, False])}
    assert store.load("key") is None
    assert store.store("key", arrays)
    loaded = store.load("key")
    assert loaded.keys() == arrays.keys()
    for name, array in arrays.items():
        assert loaded[name].dtype == array.dtype
        np.testing.assert_array_equal(loaded[name], array)


def test_cache_keys_tell_contents_apart():
    a = np.arange(4, dtype=np.float32)
    keys = [
        cache.compute_key(a), cache.compute_key(a.reshape(2, 2)), cache.compute_key(a.astype(np.float64)),
        cache.compute_key(a, a), cache.compute_key(a + 1), cache.compute_key({"a": 1}), cache.compute_key({"a": 2}),
        cache.compute_key("ab", "c"), cache.compute_key("a", "bc"),
    ]  # fmt: skip
    assert len(set(keys)) == len(keys)
    assert cache.compute_key(a.reshape(2, 2).T) == cache.compute_key(a.reshape(2, 2).T.copy())
    assert cache.compute_key({"a": 1, "b": 2}) == cache.compute_key({"b": 2, "a": 1})


def test_cache_is_bounded_and_drops_the_oldest(tmp_path):
    noise = np.random.default_rng(0).integers(0, 255, 10_000, np.uint8)
    store = cache.TruthCache(tmp_path, limit_bytes=35_000)
    now = time.time()
    for index, key in enumerate("abc"):
        store.store(key, {"x": noise})
        os.utime(tmp_path / f"{key}.npz", (now - 100 + index, now - 100 + index))
    store.load("a")  # used again: now "b" is the oldest
    store.store("d", {"x": noise})
    assert sorted(path.stem for path in tmp_path.iterdir()) == ["a", "c", "d"]
    cache.TruthCache(tmp_path, limit_bytes=1).store("e", {"x": noise})
    assert [path.stem for path in tmp_path.iterdir()] == ["e"]


def test_broken_cache_file_is_missing_and_said(tmp_path):
    store = cache.TruthCache(tmp_path)
    store.store("key", {"x": np.zeros(100)})
    path = tmp_path / "key.npz"
    path.write_bytes(path.read_bytes()[:50])
    assert store.load("key") is None and "unreadable" in store.last_error
    assert not path.exists()


def test_cache_that_can_not_be_written_is_no_failure(tmp_path):
    (tmp_path / "file").write_text("")
    store = cache.TruthCache(tmp_path / "file")
    assert not store.store("key", {"x": np.zeros(1)})
    assert "isn't cached" in store.last_error and store.load("key") is None


def test_two_writers_of_one_key_leave_a_whole_file(tmp_path):
    arrays = {"x": np.random.default_rng(0).random(50_000)}
    writers = [threading.Thread(target=lambda: cache.TruthCache(tmp_path).store("key", arrays)) for _ in range(4)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    np.testing.assert_array_equal(cache.TruthCache(tmp_path).load("key")["x"], arrays["x"])
    assert [path.name for path in tmp_path.iterdir()] == ["key.npz"]
