# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input ends in a clear report and an exit code other than 0, or in a right picture; never in a crash.

Scenes are rendered in this process; what lies outside of the scene (folders, disks, libraries) is tried with the batch
in a process of its own. What the core refuses below Blender is tested in tests/gl and tests/python.
"""

import shutil
import subprocess

import bpy
import numpy as np
import pytest
from addon_helpers import add_camera, add_light, add_object, cube_mesh, failed_render, make_mesh, plane_mesh, render


def card_over_ground(scene) -> None:
    """A square of two units, two above the ground; camera above both."""
    add_object("Ground", plane_mesh(40, "Ground"))
    add_object("Card", plane_mesh(2, "Card"), (0, 0, 2))
    add_camera((0, 0, 12))


def visibility(captured, number: int = 0) -> np.ndarray:
    assert not captured.errors
    pixels = captured.frames[0].layers[number].channels["visibility"]
    assert np.isfinite(pixels).all() and pixels.min() >= 0 and pixels.max() <= 1
    return pixels


def shadow_share(captured, number: int = 0) -> float:
    return float((visibility(captured, number) < 0.5).mean())


# --- scenes ----------------------------------------------------------------------------------------------------------
def test_empty_scene_says_what_is_missing(fresh_scene):
    add_camera()
    assert "light" in failed_render()


def test_no_light_says_what_to_add(fresh_scene):
    card_over_ground(fresh_scene)
    text = failed_render()
    assert "light" in text and "add" in text


def test_nothing_to_see_is_a_lit_background(fresh_scene):
    add_camera()
    add_light("SUN")
    captured = render()
    assert (visibility(captured) == 1).all()
    assert (captured.frames[0].coverage == 0).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 3e38])
def test_vertices_that_are_not_finite_are_dropped_and_told(fresh_scene, bad):
    card_over_ground(fresh_scene)
    add_light("SUN")
    good = shadow_share(render())
    mesh = make_mesh("Broken", [(2, 1, 1), (2.2, 1, 1), (2, 1.2, 1), (2.2, 1.2, 1)], [(0, 1, 2), (1, 3, 2)])
    mesh.vertices[3].co = (bad, 1.2, 1)
    add_object("Broken", mesh)
    captured = render()
    assert shadow_share(captured) == pytest.approx(good, abs=0.01)
    if not np.isfinite(bad):
        assert any("finite" in text or "NaN" in text for text in captured.frames[0].warnings)


def test_faces_without_area_change_nothing(fresh_scene):
    card_over_ground(fresh_scene)
    add_light("POINT", location=(0, 0, 8))
    before = visibility(render())
    points = [(0, 0, 3), (0, 0, 3), (0, 0, 3), (1, 1, 3), (2, 2, 3), (3, 3, 3)]
    add_object("Flat", make_mesh("Flat", points, [(0, 1, 2), (3, 4, 5), (0, 3, 3 + 1)]))
    assert (before != visibility(render())).mean() < 0.02


def test_light_inside_a_closed_body_lights_nothing_outside(fresh_scene):
    card_over_ground(fresh_scene)
    add_object("Cube", cube_mesh(1.0), (0, 0, 5))
    add_light("POINT", location=(0, 0, 5))
    captured = render()
    covered = captured.frames[0].coverage > 0.5
    # The camera sees the cube's top from outside, turned away from the light; all else is behind its faces.
    assert (visibility(captured)[covered] < 0.5).mean() > 0.99


def test_light_on_a_surface_is_no_crash(fresh_scene):
    card_over_ground(fresh_scene)
    for kind in ("POINT", "SPOT", "AREA"):
        add_light(kind, location=(0, 0, 0))
    captured = render()
    for number in range(3):
        visibility(captured, number)


def test_camera_inside_a_closed_body(fresh_scene):
    card_over_ground(fresh_scene)
    add_object("Cube", cube_mesh(2.0), (0, 0, 12))
    add_light("SUN")
    assert (visibility(render()) < 0.5).all()  # the inside of the cube, which the sun does not reach


def test_map_larger_than_the_driver_allows_names_the_limit(fresh_scene):
    from addon import bridge, preferences

    card_over_ground(fresh_scene)
    add_light("SUN")
    render()
    settings = preferences.session_settings(fresh_scene)
    limit = bridge.session(settings.backend, settings.threads).info["max_texture_size"]
    fresh_scene.shadow_layers.map_size = limit  # the widest picture, which leaves no room for a map's border
    try:
        captured = render()
    except RuntimeError as error:
        assert str(limit) in str(error)
    else:
        visibility(captured)


def test_five_hundred_lights_give_five_hundred_layers(fresh_scene):
    card_over_ground(fresh_scene)
    fresh_scene.render.resolution_x, fresh_scene.render.resolution_y = 32, 18
    fresh_scene.shadow_layers.map_size = 32
    for number in range(500):
        angle = number * 0.1
        add_light("POINT", f"Light {number}", (6 * np.cos(angle), 6 * np.sin(angle), 7))
    captured = render()
    assert len(captured.frames[0].layers) == 500
    shares = [shadow_share(captured, number) for number in range(500)]
    assert min(shares) > 0.01
    assert max(shares) < 0.5


def test_huge_and_tiny_objects_together(fresh_scene):
    card_over_ground(fresh_scene)
    add_light("SUN")
    good = shadow_share(render())
    add_object("Planet", cube_mesh(1e7), (0, 0, -1e7))
    add_object("Dust", cube_mesh(1e-7), (3, 0, 1))
    assert shadow_share(render()) == pytest.approx(good, abs=0.02)


# --- around the scene ------------------------------------------------------------------------------------------------
@pytest.fixture
def saved_scene(fresh_scene, tmp_path):
    card_over_ground(fresh_scene)
    add_light("SUN", "Key")
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def error_text(done) -> str:
    """What the batch says went wrong; the process ended with an exit code, not with a signal."""
    assert done.returncode > 0, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    lines = done.stderr.splitlines()
    starts = [number for number, line in enumerate(lines) if line.startswith("error: ")]
    assert len(starts) == 1, done.stdout + done.stderr
    return "\n".join(lines[starts[0] :])


def test_no_osmesa_and_no_egl_names_what_to_install(saved_scene, run_batch, tmp_path):
    """Empty files stand before the real libraries in the loader's path, so that no context can be made."""
    libraries = tmp_path / "libraries"
    libraries.mkdir()
    for name in ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so", "libEGL.so.1", "libEGL.so"):
        (libraries / name).touch()
    out = tmp_path / "out"
    env = {"LD_LIBRARY_PATH": str(libraries)}
    line = error_text(run_batch(saved_scene, "render", "--out", out, check=False, env=env))
    assert all(f"install {name}" in line for name in ("libosmesa6", "libegl1"))
    assert not [path for path in out.rglob("*") if path.is_file()]


def test_missing_shader_folder_is_named(saved_scene, run_batch, tmp_path):
    missing = tmp_path / "no_shaders"
    env = {"SHADOW_LAYERS_SHADERS": str(missing)}
    line = error_text(run_batch(saved_scene, "render", "--out", tmp_path / "out", check=False, env=env))
    assert str(missing) in line


def test_shader_that_does_not_compile_is_named(saved_scene, run_batch, project_root, tmp_path):
    shaders = shutil.copytree(project_root / "shaders", tmp_path / "shaders")
    for source in shaders.rglob("*.frag"):
        source.write_text(source.read_text() + "\nthis is no GLSL\n")
    env = {"SHADOW_LAYERS_SHADERS": str(shaders)}
    line = error_text(run_batch(saved_scene, "render", "--out", tmp_path / "out", check=False, env=env))
    assert ".frag" in line


def mounted(options: str, folder) -> list[str]:
    """Command prefix that runs the rest with a small file system of its own on `folder`."""
    script = f'mount -t tmpfs -o {options} none "{folder}" && exec "$@"'
    prefix = ["unshare", "--mount", "sh", "-c", script, "sh"]
    if subprocess.run([*prefix, "true"], capture_output=True, check=False).returncode:
        pytest.skip("this process may not mount a file system")
    return prefix


@pytest.mark.parametrize(("options", "word"), [("ro", "read-only"), ("size=16k", "")])
def test_file_system_that_is_read_only_or_full(saved_scene, run_batch, tmp_path, options, word):
    out = tmp_path / "out"
    out.mkdir()
    done = run_batch(saved_scene, "render", "--resolution", "640x360", "--out", out, check=False,
                     prefix=mounted(options, out))  # fmt: skip
    line = error_text(done)
    assert str(out) in line
    assert word in line.lower()
