# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The soft truth from Cycles against closed forms: the shadow of a straight edge under each kind of light."""

import math

import bpy
import numpy as np
import pytest

truth = pytest.importorskip("addon.truth")

WIDTH, HEIGHT = 64, 24
# The edge lies halfway between light and ground, so the penumbra is as wide as the light.
LIGHT_Z, EDGE_Z = 20.0, 10.0
SPAN = 1.6
SIZE = 0.8


@pytest.fixture
def scene():
    """A ground, a half plane x < 0 over it that only casts, and a camera straight down at the edge's shadow."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    add_rectangle("Ground", -30, 30, 0.0)
    add_rectangle("Plate", -30, 0, EDGE_Z).visible_camera = False
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", SPAN
    scene.camera = add("Camera", camera, (0, 0, 30))
    return scene


def add(name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    made.location, made.rotation_euler = location, rotation
    return made


def add_rectangle(name, x0, x1, z):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(x0, -30, z), (x1, -30, z), (x1, 30, z), (x0, 30, z)], [], [(0, 1, 2, 3)])
    return add(name, mesh)


def add_light(kind, rotation=(0, 0, 0), **settings):
    light = bpy.data.lights.new("Key", kind)
    for key, value in settings.items():
        setattr(light, key, value)
    return add("Key", light, (0, 0, LIGHT_Z), rotation)


def render(scene, samples=32):
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        return cycles.render_soft_light("Key", samples)


def places():
    """Distance of each column from the middle, which is the edge's hard shadow, in parts of the light's size."""
    return ((np.arange(WIDTH) + 0.5) / WIDTH - 0.5) * SPAN / SIZE


def disc_part(x):
    """Of a disc of diameter 1, the part on one side of a line at distance x from its middle."""
    t = np.clip(2 * x, -1, 1)
    return 0.5 + (t * np.sqrt(1 - t * t) + np.arcsin(t)) / np.pi


def square_part(x):
    return np.clip(0.5 + x, 0, 1)


LIGHTS = {
    # From the ground a ball of radius r at 20 looks like a disc; the edge halfway casts each of its points as far away.
    "ball": ("POINT", {"shadow_soft_size": SIZE / 2}, disc_part),
    "spot": ("SPOT", {"shadow_soft_size": SIZE / 2, "spot_size": 1.0, "spot_blend": 0.5}, disc_part),
    "square": ("AREA", {"shape": "SQUARE", "size": SIZE}, square_part),
    "rectangle": ("AREA", {"shape": "RECTANGLE", "size": SIZE, "size_y": 3.0}, square_part),
    "disc": ("AREA", {"shape": "DISK", "size": SIZE}, disc_part),
    "ellipse": ("AREA", {"shape": "ELLIPSE", "size": SIZE, "size_y": 0.2, "spread": 1.0}, disc_part),
    # The sun's disc, cast from EDGE_Z.
    "sun": ("SUN", {"angle": 2 * math.atan(SIZE / 2 / EDGE_Z)}, disc_part),
}


@pytest.mark.parametrize("name", LIGHTS)
def test_penumbra_of_a_straight_edge(scene, name):
    """The light's part beyond the edge, within the standard error that is reported. What Cycles weighs the light's
    points by (cosines, distance) differs by less than a thousandth over this light."""
    kind, settings, part = LIGHTS[name]
    add_light(kind, **settings)
    result = render(scene)
    assert result.samples == 32 and result.lit.all()
    expected = np.broadcast_to(part(places()), (HEIGHT, WIDTH))
    wrong = result.visibility - expected
    inside = (expected > 0.02) & (expected < 0.98)
    assert (np.abs(wrong[(expected == 0) | (expected == 1)]) < 1e-3).all()
    reported = np.sqrt(np.mean(np.square(result.error[inside])))
    assert 0.7 * reported < np.sqrt(np.mean(np.square(wrong[inside]))) < 1.4 * reported < 0.08
    # Together the pixels know the ramp much better than each: no bias beyond what they leave open.
    mean_error = np.sqrt(np.sum(np.square(result.error[inside]))) / inside.sum()
    assert abs(wrong[inside].mean()) < 4 * mean_error + 1e-3
    columns = np.abs(wrong.mean(axis=0))[inside[0]]
    assert columns.max() < 5 * reported / math.sqrt(HEIGHT) + 1e-3


def test_more_samples_leave_less_error(scene):
    add_light("AREA", size=SIZE)
    errors = [np.sqrt(np.mean(np.square(render(scene, samples).error))) for samples in (8, 128)]
    assert errors[1] < 0.3 * errors[0]
    assert render(scene, 9).samples == 12


def test_light_without_size_is_the_hard_truth(scene):
    add_light("POINT", shadow_soft_size=0.0)
    soft = render(scene, 8)
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        hard = cycles.render_light("Key")
    np.testing.assert_array_equal(soft.visibility, hard.visible)
    assert soft.error.max() == 0


def test_tilted_area_light_lights_its_front_only(scene):
    """Turned upright, it shines along the ground's y axis: what lies behind it gets nothing."""
    add_light("AREA", (math.pi / 2, 0, 0), size=0.3)
    bpy.data.objects["Key"].location.z = 0.5
    result = render(scene, 8)
    y = ((np.arange(HEIGHT) + 0.5) / HEIGHT - 0.5) * SPAN * HEIGHT / WIDTH
    assert not result.lit[y < -0.01].any() and result.lit[y > 0.01].all()


def test_ratio_and_error_of_renders():
    pairs = np.array([[[[1.0, 0.0, 0.0]], [[2.0, 2.0, 0.0]]], [[[2.0, 0.0, 0.0]], [[2.0, 2.0, 0.0]]]], np.float32)
    result = truth.compute_soft_truth(pairs, 8, {})
    np.testing.assert_allclose(result.visibility, [[0.75, 0, 0]])
    np.testing.assert_allclose(result.error, [[0.25, 0, 0]], atol=1e-7)
    assert result.lit.tolist() == [[True, True, False]]


def test_scene_is_left_as_it_was(scene):
    light = add_light("AREA", shape="DISK", size=2.0, spread=1.0)
    scene.cycles.seed, scene.cycles.samples = 7, 77
    light.data.cycles.use_multiple_importance_sampling = True
    light.visible_camera = True
    count = len(bpy.data.lights)
    shown = render(scene, 8)
    assert shown.lit.all()
    assert (scene.cycles.seed, scene.cycles.samples, len(bpy.data.lights)) == (7, 77, count)
    assert light.data.cycles.use_multiple_importance_sampling and light.visible_camera and light.data.spread == 1.0
