# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera's window against Blender's view frame, and the render's size, border and filter."""

import itertools
import random

import bpy
import numpy as np
import pytest
from addon_helpers import add_camera, add_light, add_object, exported, failed_render, plane_mesh
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector


@pytest.fixture
def scene(fresh_scene):
    add_light("SUN")
    add_object("Ground", plane_mesh(10))
    return fresh_scene


def project(snapshot, point) -> tuple[float, float]:
    """Where a world point falls on the full picture, 0..1, by the exported camera."""
    camera = snapshot.camera
    x, y, z, _ = np.linalg.inv(camera.world_from_camera) @ (*point, 1.0)
    if camera.perspective:
        x, y = x / -z, y / -z
    left, right, bottom, top = camera.window
    return (x - left) / (right - left), (y - bottom) / (top - bottom)


def assert_projects_like_blender(scene, snapshot, tolerance=2e-5):
    rng = random.Random(1)
    camera = scene.camera
    for _ in range(20):
        local = Vector((rng.uniform(-3, 3), rng.uniform(-3, 3), -rng.uniform(2, 20)))
        point = camera.matrix_world.normalized() @ local
        expected = world_to_camera_view(scene, camera, point)
        assert project(snapshot, point) == pytest.approx(expected[:2], abs=tolerance * max(1, expected.length))


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("fit", ["AUTO", "HORIZONTAL", "VERTICAL"])
def test_window_with_every_fit_shift_size_and_aspect(scene, kind, fit):
    camera = add_camera((1, -2, 3), sensor_fit=fit, lens=35, sensor_width=30, sensor_height=20, ortho_scale=7)
    camera.data.type = kind
    camera.rotation_euler = (0.9, 0.2, 0.4)
    cases = itertools.product([(64, 36), (36, 64)], [(1, 1), (2, 1), (1, 1.5)], [(0, 0), (0.3, -0.2)], [100, 50])
    for size, aspect, shift, percentage in cases:
        scene.render.resolution_x, scene.render.resolution_y = size
        scene.render.resolution_percentage = percentage
        scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = aspect
        camera.data.shift_x, camera.data.shift_y = shift
        snapshot = exported()
        assert snapshot.camera.perspective == (kind == "PERSP")
        assert (snapshot.render.width, snapshot.render.height) == tuple(v * percentage // 100 for v in size)
        assert_projects_like_blender(scene, snapshot)


@pytest.mark.parametrize("lens", [5000, 250, 50, 5, 1])
def test_window_from_long_to_wide_lenses(scene, lens):
    camera = add_camera((0, 0, 5), lens=lens, sensor_fit="HORIZONTAL", sensor_width=36)
    snapshot = exported()
    left, right, _, _ = snapshot.camera.window
    assert right - left == pytest.approx(36 / camera.data.lens, rel=1e-6)
    assert right + left == pytest.approx(0, abs=1e-6 * (right - left))


@pytest.mark.parametrize("scale", [(2, 2, 2), (1, 5, 0.1), (-1, 1, 1)])
def test_scale_of_the_camera_is_removed(scene, scale):
    camera = add_camera((1, 2, 3))
    camera.rotation_euler = (0.5, 0.6, 0.7)
    camera.scale = scale
    axes = exported().camera.world_from_camera[:3, :3]
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    expected = np.array(camera.matrix_world.normalized())[:3, :3]
    np.testing.assert_allclose(axes, expected, atol=1e-6)


def test_clipping_is_taken_over(scene):
    add_camera(clip_start=0.25, clip_end=77)
    camera = exported().camera
    assert (camera.clip_start, camera.clip_end) == pytest.approx((0.25, 77))


def test_a_marker_switches_the_camera(scene):
    first, second = add_camera((0, 0, 10), "First"), add_camera((5, 0, 10), "Second")
    for frame, camera in ((1, first), (5, second)):
        scene.timeline_markers.new("m", frame=frame).camera = camera
    scene.frame_set(1)
    assert exported().camera.world_from_camera[0, 3] == pytest.approx(0)
    scene.frame_set(5)
    assert exported().camera.world_from_camera[0, 3] == pytest.approx(5)


def test_a_light_may_be_the_camera(scene):
    spot = add_light("SPOT", location=(0, 0, 8), spot_size=1.0)
    scene.camera = spot
    assert exported().camera.world_from_camera[2, 3] == pytest.approx(8)


def test_panoramic_cameras_are_refused_by_name(scene):
    add_camera(name="Globe").data.type = "PANO"
    text = failed_render()
    assert '"Globe"' in text
    assert "Perspective or Orthographic" in text


def test_borders_cover_the_pixels_that_blender_wants(scene):
    # The engine compares its region with Blender's and refuses a difference, so that a plain render is the check.
    add_camera()
    rng = random.Random(7)
    scene.render.use_border = True
    for crop in (False, True):
        scene.render.use_crop_to_border = crop
        for _ in range(25):
            scene.render.resolution_x, scene.render.resolution_y = rng.randint(5, 90), rng.randint(5, 90)
            x0, y0 = rng.uniform(0, 0.6), rng.uniform(0, 0.6)
            scene.render.border_min_x, scene.render.border_min_y = x0, y0
            scene.render.border_max_x, scene.render.border_max_y = x0 + rng.uniform(0.3, 0.4), y0 + 0.35
            snapshot = exported()
            x, y, width, height = snapshot.render.region
            assert abs(x - x0 * snapshot.render.width) <= 1
            assert abs(y - y0 * snapshot.render.height) <= 1
            assert width > 0
            assert height > 0


def test_samples_and_filter_of_the_scene(scene):
    add_camera()
    scene.shadow_layers.samples = 8
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", 2.5
    render = exported().render
    assert (render.samples, render.filter, render.filter_width) == (8, "GAUSSIAN", pytest.approx(2.5))


def test_dof_and_motion_blur_are_named(scene):
    camera = add_camera(name="Lens")
    camera.data.dof.use_dof = True
    scene.render.use_motion_blur = True
    text = "\n".join(exported().warnings)
    assert 'depth of field of camera "Lens"' in text
    assert "motion blur" in text


def test_no_camera_is_blenders_own_error(scene):
    scene.camera = None
    with pytest.raises(RuntimeError, match=r"(?i)camera"):
        bpy.ops.render.render()
