# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""shadow_core.Session: pictures out, threads, callbacks, cancelling, closing, the interpreter's end."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import small_scene

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

from compare.footprint import choose_views

SIZE = {"width": 64, "height": 48}
# Slow enough to be met in the middle on any machine, and stopped long before its end.
LONG = {"width": 640, "height": 480, "samples": 64}


@pytest.fixture
def session(core, shader_dir):
    with core.Session(backend="osmesa", shader_dir=shader_dir, threads=2) as made:
        yield made


def long_jobs(count=40):
    return [(index, "sm", {"map_size": 2048}) for index in range(count)]


def render_long(core, session, **options):
    return session.render(
        small_scene.make_scene(core, 40), small_scene.make_camera(core), long_jobs(), **(LONG | options)
    )


def test_layers_are_pictures_of_the_shadow(core, session):
    scene, camera = small_scene.make_scene(core), small_scene.make_camera(core)
    jobs = [(0, "sm", {"map_size": 256})]
    result = session.render(scene, camera, jobs, width=64, height=64, aux=["normal", "depth", "ids"])
    (layer,) = result.layers
    visibility = layer.channels["visibility"]
    assert (layer.job, layer.light, layer.technique) == (0, 0, "sm")
    assert layer.parameters["map_size"] == 256
    assert visibility.shape == (64, 64) and visibility.dtype == np.float32 and visibility.flags.c_contiguous
    # The camera spans 8 units over 64 pixels; the box's shadow spans the middle 2 units.
    assert visibility[32, 32] == 0 and visibility[4, 4] == 1
    assert abs((1 - visibility).sum() - 16 * 16) < 70
    assert result.coverage.shape == (64, 64) and result.coverage.min() == 1
    assert result.combined.shape == (64, 64, 4)
    assert result.aux["normal"].shape == (64, 64, 3) and np.allclose(result.aux["normal"][10, 10], [0, 1, 0])
    assert np.allclose(result.aux["depth"], 10)
    assert result.aux["ids"].shape == (64, 64, 2) and result.aux["ids"].dtype == np.int64
    assert result.camera_position == (0.0, 10.0, 0.0)
    assert layer.times and {"stage", "cpu_ms", "gl_ms"} == set(layer.times[0])
    assert layer.total_ms > 0 and result.total_ms > 0
    assert all(isinstance(count, int) for count in layer.counters.values())


@pytest.mark.parametrize("kind", ["SUN", "SPOT", "POINT", "AREA"])
def test_views_tell_where_a_point_lies_in_the_map(core, session, kind):
    """sm asks one texel: on the flat ground all pixels of a texel are equal, and the shadow's edges lie between."""
    scene = small_scene.make_scene(core, lights=0)
    turn = np.array([[0.8, 0.6, 0, 0], [-0.6, 0.8, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    scene.add_light("light", kind, small_scene.looking_down(6.0) @ turn, spot_angle=1.9)
    options = {"width": 200, "height": 200, "aux": ["position"]}
    result = session.render(scene, small_scene.make_camera(core), [(0, "sm", {"map_size": 32})], **options)
    (layer,) = result.layers
    points = np.ones((200 * 200, 4))
    points[:, :3] = result.aux["position"].reshape(-1, 3) + np.array(result.camera_position)
    assert sum(view["face"] < 0 for view in layer.views) == (1 if kind in ("SUN", "SPOT") else 0)
    assert [view["perspective"] for view in layer.views] == [kind != "SUN"] * len(layer.views)
    visibility, seen = layer.channels["visibility"].ravel(), np.zeros(len(points), int)
    chosen = choose_views([(points @ view["view_from_world"].T)[:, :3] for view in layer.views])
    for index, view in enumerate(layer.views):
        x, y, z, _ = (points @ view["view_from_world"].T).T
        in_face = (view["face"] < 0) | ((-z > np.abs(x) + 1e-6) & (-z > np.abs(y) + 1e-6))
        across = np.stack([x, y], axis=1) / (-z[:, None] if view["perspective"] else 1)
        place = (across - view["corner"]) / view["texel_size"]
        certain = in_face & (np.abs(place - np.round(place)).min(axis=1) > 1e-3)
        texel = np.floor(place).astype(int) @ (1, 1000)
        shadow, lit = (set(texel[certain & (visibility == value)]) for value in (0, 1))
        assert shadow.isdisjoint(lit)
        assert (chosen[in_face] == index).all()
        seen += in_face
    assert seen.max() == 1 and seen.mean() > 0.98 and 0.02 < (visibility == 0).mean() < 0.4


def test_row_zero_is_at_the_bottom_and_the_region_is_cut_out(core, session):
    scene, camera = small_scene.make_scene(core), small_scene.make_camera(core)
    jobs = [(0, "sm", {"map_size": 256})]
    whole = session.render(scene, camera, jobs, **SIZE).layers[0].channels["visibility"]
    part = session.render(scene, camera, jobs, **SIZE, region=(20, 10, 30, 25)).layers[0].channels["visibility"]
    assert part.shape == (25, 30)
    assert np.mean(part != whole[10:35, 20:50]) < 0.02


def test_pixels_are_handed_over_not_copied(core, session):
    result = session.render(small_scene.make_scene(core), small_scene.make_camera(core), [(0, "sm", {})], **SIZE)
    for array in (result.coverage, result.combined, result.layers[0].channels["visibility"]):
        assert not array.flags.owndata
        assert type(array.base).__name__ == "PyCapsule"
        assert array.flags.writeable


def test_pixels_outlive_everything_else(core, shader_dir):
    session = core.Session(backend="osmesa", shader_dir=shader_dir)
    visibility = (
        session.render(small_scene.make_scene(core), small_scene.make_camera(core), [(0, "sm", {})], **SIZE)
        .layers[0]
        .channels["visibility"]
    )
    before = visibility.copy()
    session.close()
    del session
    assert np.array_equal(before, visibility)


def test_on_layer_gets_each_layer_on_this_thread(core, session):
    seen, progress = [], []
    result = session.render(
        small_scene.make_scene(core, 3),
        small_scene.make_camera(core),
        [(2, "sm", {}), (0, "sm", {}), (1, "sm", {})],
        **SIZE,
        combined=False,
        on_layer=lambda layer: seen.append((layer.job, layer.light, threading.get_ident())),
        on_progress=lambda fraction, text: progress.append((fraction, text)),
    )
    me = threading.get_ident()
    assert seen == [(0, 2, me), (1, 0, me), (2, 1, me)]
    assert result.layers == [] and result.combined is None
    fractions = [fraction for fraction, _ in progress]
    assert fractions == sorted(fractions) and fractions[0] >= 0 and fractions[-1] <= 1
    assert all(isinstance(text, str) for _, text in progress)


def test_a_callback_may_not_render_with_the_same_session(core, session):
    scene, camera = small_scene.make_scene(core), small_scene.make_camera(core)
    with pytest.raises(core.InputError, match="second session"):
        session.render(
            scene, camera, [(0, "sm", {})], **SIZE, on_layer=lambda _: session.render(scene, camera, [], **SIZE)
        )
    assert len(session.render(scene, camera, [(0, "sm", {})], **SIZE).layers) == 1


@pytest.mark.parametrize("callback", ["on_layer", "on_progress"])
def test_what_a_callback_raises_ends_the_render(core, session, callback):
    class Boom(Exception):
        pass

    calls = []

    def fail(*arguments):
        calls.append(arguments)
        raise Boom

    with pytest.raises(Boom):
        render_long(core, session, **{callback: fail})
    assert len(calls) == 1
    again = session.render(small_scene.make_scene(core), small_scene.make_camera(core), [(0, "sm", {})], **SIZE)
    assert len(again.layers) == 1


def test_other_threads_run_meanwhile(core, session):
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.005):
            ticks.append(time.monotonic())

    ticker = threading.Thread(target=tick)
    ticker.start()
    canceller = threading.Timer(0.5, session.cancel)
    canceller.start()
    with pytest.raises(core.Cancelled):
        render_long(core, session)
    stop.set()
    ticker.join()
    canceller.join()
    assert len(ticks) > 20


def test_cancel_from_another_thread(core, session):
    cancelled_at = []

    def cancel():
        cancelled_at.append(time.monotonic())
        session.cancel()

    timer = threading.Timer(0.3, cancel)
    timer.start()
    with pytest.raises(core.Cancelled):
        render_long(core, session)
    timer.join()
    assert time.monotonic() - cancelled_at[0] < 5  # the 300 ms are measured by the core's benchmark
    session.cancel()  # without a render: nothing
    assert (
        len(session.render(small_scene.make_scene(core), small_scene.make_camera(core), [(0, "sm", {})], **SIZE).layers)
        == 1
    )


def test_close_during_a_render(core, shader_dir):
    session = core.Session(backend="osmesa", shader_dir=shader_dir)
    timer = threading.Timer(0.3, session.close)
    timer.start()
    with pytest.raises(core.Error):
        render_long(core, session)
    timer.join()
    with pytest.raises(core.Error, match="closed"):
        render_long(core, session)


def test_a_closed_session_says_so(core, shader_dir):
    session = core.Session(backend="osmesa", shader_dir=shader_dir)
    assert session.info["backend"] == "osmesa"
    session.close()
    session.close()
    session.cancel()
    for use in (lambda: session.info, lambda: session.host_bytes, lambda: session.gpu_bytes, session.__enter__):
        with pytest.raises(core.Error, match="closed"):
            use()


def test_sessions_can_follow_and_stand_beside_each_other(core, shader_dir):
    scene, camera, jobs = small_scene.make_scene(core), small_scene.make_camera(core), [(0, "sm", {})]
    pictures = []
    for _ in range(3):
        with (
            core.Session(backend="osmesa", shader_dir=shader_dir) as a,
            core.Session(backend="osmesa", shader_dir=shader_dir) as b,
        ):
            pictures += [s.render(scene, camera, jobs, **SIZE).layers[0].channels["visibility"] for s in (a, b)]
    assert all(np.array_equal(pictures[0], picture) for picture in pictures)


def test_a_scene_given_away_takes_no_more(core, session):
    scene = small_scene.make_scene(core)
    session.render(scene, small_scene.make_camera(core), [(0, "sm", {})], **SIZE)
    with pytest.raises(core.InputError, match="given to a render"):
        scene.add_light("late", "SUN", np.eye(4))
    with pytest.raises(core.InputError, match="given to a render"):
        scene.add_mesh("late", small_scene.BOX.copy(), small_scene.BOX_TRIANGLES.copy())


def test_scenes_may_die_while_others_render(core, session):
    """The last owner of an array may be the worker: nobody may wait for the GIL there."""
    camera = small_scene.make_camera(core)
    failures = []

    def work():
        try:
            for _ in range(15):
                session.render(small_scene.make_scene(core), camera, [(0, "sm", {"map_size": 64})], **SIZE)
        except Exception as error:  # reported below, in the main thread
            failures.append(error)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
        assert not thread.is_alive()
    assert failures == []


BAD_REQUESTS = [
    ({"jobs": [(7, "sm", {})]}, "InputError", "7"),
    ({"jobs": [(-1, "sm", {})]}, "InputError", r"jobs\[0\]"),
    ({"jobs": [(0, "nonesuch", {})]}, "InputError", "nonesuch"),
    ({"jobs": [(0, "sm", {"map_size": 0})]}, "InputError", "map_size"),
    ({"jobs": [(0, "sm", {"map_size": 1 << 30})]}, "Error", "map_size"),
    ({"jobs": [(0, "sm", {"map_size": None})]}, "TypeError", r"jobs\[0\]\[2\]\['map_size'\]"),
    ({"jobs": [(0, "sm")]}, "TypeError", r"jobs\[0\]"),
    ({"jobs": ["sm"]}, "TypeError", r"jobs\[0\]"),
    ({"jobs": [(0, 5, {})]}, "TypeError", r"jobs\[0\]\[1\]"),
    ({"jobs": [(0.5, "sm", {})]}, "TypeError", "light index"),
    ({"width": 0}, "InputError", "width|size|0"),
    ({"height": -3}, "InputError", "height|size|-3"),
    ({"width": 10**6}, "Error", "1000000"),
    ({"region": (0, 0, 0, 5)}, "InputError", "region"),
    ({"region": (60, 0, 30, 5)}, "InputError", "region"),
    ({"region": (0.5, 0, 3, 5)}, "InputError", "region"),
    ({"region": "all"}, "InputError", "region"),
    ({"samples": 0}, "InputError", "samples"),
    ({"samples": 65}, "InputError", "samples"),
    ({"filter": "LANCZOS"}, "InputError", "LANCZOS"),
    ({"filter_width": -1.0, "samples": 4}, "InputError", "filter"),
    ({"aux": ["motion"]}, "InputError", "motion"),
]


@pytest.mark.parametrize(("change", "error", "text"), BAD_REQUESTS)
def test_bad_requests_are_named(core, session, change, error, text):
    expected = TypeError if error == "TypeError" else getattr(core, error)
    arguments = {"jobs": [(0, "sm", {})], **SIZE} | change
    with pytest.raises(expected, match=text):
        session.render(small_scene.make_scene(core), small_scene.make_camera(core), **arguments)
    assert session.render(small_scene.make_scene(core), small_scene.make_camera(core), [(0, "sm", {})], **SIZE).layers


def test_bad_session_options_are_named(core, shader_dir, tmp_path):
    with pytest.raises(core.Error, match="metal"):
        core.Session(backend="metal", shader_dir=shader_dir)
    with pytest.raises(core.Error, match="nowhere"):
        core.Session(backend="osmesa", shader_dir=str(tmp_path / "nowhere"))
    with pytest.raises(TypeError):
        core.Session(backend="osmesa", shader_dir=7)
    for name in ("gpu_cache_bytes", "host_cache_bytes"):
        with pytest.raises(core.InputError, match=name):
            core.Session(backend="osmesa", shader_dir=shader_dir, **{name: -1})


# --- in an interpreter of its own ---

PRELUDE = """
    import sys, threading, time, os, signal
    sys.path[:0] = [{module_dir!r}, {test_dir!r}]
    import shadow_core as core, small_scene
    session = core.Session(backend="osmesa", shader_dir={shader_dir!r})
    scene, camera = small_scene.make_scene(core, 40), small_scene.make_camera(core)
    jobs = [(index, "sm", {{"map_size": 2048}}) for index in range(40)]
    def render_long():
        return session.render(scene, camera, jobs, width=640, height=480, samples=64)
"""


@pytest.fixture
def start_python(module_dir, shader_dir):
    def start(code):
        prelude = PRELUDE.format(module_dir=str(module_dir), test_dir=str(Path(__file__).parent), shader_dir=shader_dir)
        text = textwrap.dedent(prelude) + textwrap.dedent(code)
        return subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, check=False)

    return start


def test_the_interpreter_ends_with_an_open_session(start_python):
    done = start_python("""
        session.render(scene, camera, jobs[:1], width=32, height=32)
        keep = session
        print("end")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")


def test_the_interpreter_ends_during_a_render(start_python):
    done = start_python("""
        def work():
            try:
                render_long()
            except core.Error:
                pass
        threading.Thread(target=work, daemon=True).start()
        time.sleep(0.4)
        print("end")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")


def test_ctrl_c_ends_the_render(start_python):
    done = start_python("""
        threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
        started = time.monotonic()
        try:
            render_long()
        except KeyboardInterrupt:
            print("interrupted", time.monotonic() - started < 10)
        print(len(session.render(scene, camera, jobs[:1], width=32, height=32).layers))
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "interrupted True\n1\n", "")


def test_an_array_may_lose_its_last_owner_after_the_interpreter(start_python):
    done = start_python("""
        import shadow_core
        shadow_core.kept = scene  # the module's dict dies last
        session.render(scene, camera, jobs[:1], width=32, height=32)
    """)
    assert (done.returncode, done.stderr) == (0, "")


def test_killed_by_a_signal_it_dies_at_once(start_python):
    done = start_python("""
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGTERM)).start()
        render_long()
    """)
    assert done.returncode == -signal.SIGTERM


def test_without_gl_it_says_what_to_install(module_dir, shader_dir, tmp_path):
    for name in ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so", "libEGL.so.1", "libEGL.so"):
        (tmp_path / name).write_text("no library")
    code = f"""
import sys
sys.path.insert(0, {str(module_dir)!r})
import shadow_core
try:
    shadow_core.Session(shader_dir={shader_dir!r})
except shadow_core.ContextError as error:
    print(error)
"""
    environment = os.environ | {"LD_LIBRARY_PATH": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
    assert "install" in done.stdout and "OSMesa" in done.stdout and "EGL" in done.stdout
