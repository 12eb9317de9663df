# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport in Rendered mode, in a real window under Xvfb, judged by its screenshots."""

import json
import os
import shutil
import subprocess

import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.skipif(not bpy.app.binary_path, reason="the bpy module has no window")


@pytest.fixture(scope="module")
def session(addon, project_root, tmp_path_factory):
    """Screenshots by step (h, w, 3) and the record of viewport_session.py."""
    assert shutil.which("xvfb-run"), "install xvfb: a window is needed for this test"
    out = tmp_path_factory.mktemp("viewport")
    script = project_root / "tests" / "blender" / "viewport_session.py"
    command = ["xvfb-run", "-a", "-s", "-screen 0 1000x700x24", bpy.app.binary_path, "--factory-startup"]
    command += ["--window-geometry", "0", "0", "900", "650", "-P", str(script), "--", str(project_root), str(out)]
    environment = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, env=environment, check=False)
    log = done.stdout + done.stderr
    assert done.returncode == 0, log
    assert (out / "record.json").exists(), log
    pictures = {path.stem: load_png(path) for path in sorted(out.glob("*.png"))}
    return pictures, json.loads((out / "record.json").read_text()), log


def load_png(path) -> np.ndarray:
    image = bpy.data.images.load(str(path))
    width, height = image.size
    pixels = np.array(image.pixels[:], np.float32).reshape(height, width, 4)[..., :3]
    bpy.data.images.remove(image)
    return pixels


def brightness(session, step: str) -> dict[str, float]:
    """Mean brightness around each probe point in the screenshot of a step."""
    pictures, record, _ = session
    found = {}
    for name, (x, y) in record["steps"][step].items():
        column, row = int(x), int(y)
        found[name] = float(pictures[step][row - 2 : row + 3, column - 2 : column + 3].mean())
    return found


@pytest.mark.parametrize(
    ("step", "dark"),
    [
        ("enter_rendered_mode", "first"),
        ("move_cube", "cube moved"),
        ("turn_sun", "sun moved"),
        ("look_in_perspective", "sun moved"),
        ("look_through_camera", "sun moved"),
        ("hide_cube", None),
        ("switch_light_off", None),
        ("edit_mesh", "first"),
        ("enter_edit_mode", "cube moved"),
        ("leave_edit_mode", "first"),
    ],
)
def test_the_shadow_is_where_the_edit_put_it(session, step, dark):
    found = brightness(session, step)
    lit = found["never"]
    assert lit > 0.2
    for name, value in found.items():
        if name == dark:
            assert value < 0.7 * lit, (name, found)
        else:
            assert value == pytest.approx(lit, abs=0.05), (name, found)


def test_the_picture_covers_the_region(session):
    pictures, _, _ = session
    picture = pictures["enter_rendered_mode"]
    # From above, ground fills the view: no pixel of Blender's own background may be left in the inner part.
    inner = picture[20:-20, 20:-20].mean(axis=2)
    lit = brightness(session, "enter_rendered_mode")["never"]
    assert (np.abs(inner - lit) < 0.06).mean() > 0.8


def test_leaving_rendered_mode_ends_the_worker(session):
    _, record, log = session
    assert record["open while rendered"] == 1
    assert record["open afterwards"] == 0
    assert "Traceback" not in log


def test_a_render_beside_the_viewport_shows_the_same(session):
    """F12 as a job, while the viewport is live: the file is there, and its shadow is the viewport's."""
    pictures, _, log = session
    assert "final" in pictures, log
    final = pictures["final"].mean(axis=2)
    height, width = final.shape
    assert (width, height) == (320, 180)
    # The camera looks down from 30 m with Blender's default lens; the shadow lies below it, at the middle.
    seen = brightness(session, "edit_mesh")
    assert final[height // 2, width // 2] == pytest.approx(seen["first"], abs=0.03)
    assert final[height // 8, width // 2] == pytest.approx(seen["never"], abs=0.03)


def test_moving_an_object_reads_no_mesh_again(session):
    at_first, after_move, after_edit = session[1]["arrays"]
    assert at_first == after_move
    assert len(set(after_edit) & set(at_first)) == 1  # the ground's
