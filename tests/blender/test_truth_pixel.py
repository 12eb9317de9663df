# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixel truth from Cycles against closed forms: parts of the pixels' squares beyond straight edges."""

import math

import bpy
import numpy as np
import pytest

truth = pytest.importorskip("addon.truth")

WIDTH, HEIGHT = 80, 64
SPAN = 4.0
TURN = 0.35  # of the camera about its view: the edge crosses the pixels aslant


@pytest.fixture
def scene():
    """A camera straight down, turned about its view."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", SPAN
    scene.camera = add("Camera", camera, (0, 0, 30), (0, 0, TURN))
    return scene


def add(name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    made.location, made.rotation_euler = location, rotation
    return made


def add_rectangle(name, x0, x1, z0=0.0, z1=None):
    """From x0 at height z0 to x1 at height z1, long in y."""
    z1 = z0 if z1 is None else z1
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(x0, -30, z0), (x1, -30, z1), (x1, 30, z1), (x0, 30, z0)], [], [(0, 1, 2, 3)])
    return add(name, mesh)


def add_light(kind, location=(0, 0, 20), rotation=(0, 0, 0), **settings):
    light = bpy.data.lights.new("Key", kind)
    for key, value in settings.items():
        setattr(light, key, value)
    return add("Key", light, location, rotation)


def render(scene, samples=64):
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        return cycles.render_pixel_light("Key", samples)


def part_beyond(edge):
    """Of each pixel's square, (h, w), the part with x > edge on the ground: of a unit square by its corners."""
    size = SPAN / WIDTH
    a, b = size * math.cos(TURN), size * math.sin(TURN)
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    x = (columns + 0.5 - WIDTH / 2) * a - (rows + 0.5 - HEIGHT / 2) * b
    c = 0.5 * (a + b) - (edge - x)
    corners = [np.square(np.maximum(value, 0)) for value in (c, c - a, c - b, c - a - b)]
    return (corners[0] - corners[1] - corners[2] + corners[3]) / (2 * a * b)


def check(result, edge, *, flip=False):
    """Within the standard error that is reported; where the edge doesn't pass exactly 0 or 1."""
    expected = 1 - part_beyond(edge) if flip else part_beyond(edge)
    crossed = (expected > 1e-9) & (expected < 1 - 1e-9)
    np.testing.assert_array_equal(result.visibility[~crossed], np.round(expected[~crossed]))
    wrong = (result.visibility - expected)[crossed]
    inside = crossed & (expected > 0.05) & (expected < 0.95)
    reported = np.sqrt(np.mean(np.square(result.error[inside])))
    assert 0.7 * reported < np.sqrt(np.mean(np.square((result.visibility - expected)[inside]))) < 1.4 * reported < 0.08
    assert abs(wrong.mean()) < 4 * reported / math.sqrt(crossed.sum())


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA", "SUN"])
def test_shadow_of_a_straight_edge(scene, kind):
    """The light stands over the edge, so that the shadow ends under it, whatever the light's size."""
    add_rectangle("Ground", -30, 30)
    add_rectangle("Plate", -30, 0.013, 10.0).visible_camera = False
    sizes = {"SUN": {"angle": 0.1}, "AREA": {"size": 1.0}, "SPOT": {"spot_size": 1.0}}
    add_light(kind, (0.013, 0, 20), **sizes.get(kind, {"shadow_soft_size": 0.5}))
    result = render(scene)
    assert result.samples == 64 and result.lit.all()
    check(result, 0.013)


def test_more_samples_leave_less_error(scene):
    add_rectangle("Ground", -30, 30)
    add_rectangle("Plate", -30, 0, 10.0).visible_camera = False
    add_light("SUN")
    few, many = (render(scene, samples) for samples in (16, 256))
    assert (few.samples, many.samples) == (16, 256)
    errors = [np.sqrt(np.mean(np.square(result.error))) for result in (few, many)]
    assert errors[1] < 0.2 * errors[0]


# ---- what a place counts that the light doesn't shine on


def test_background_counts_as_lit(scene):
    add_rectangle("Card", -30, -0.11)
    add_rectangle("Plate", -30, 30, 10.0).visible_camera = False
    add_light("SUN")
    check(render(scene), -0.11)


@pytest.mark.parametrize("kind", ["SUN", "SPOT"])
def test_turned_away_counts_as_dark(scene, kind):
    add_rectangle("Left", -30, -0.11, -30, 0)
    add_rectangle("Right", -0.11, 30, 0, -30)
    add_light(kind, (20, 0, 2), (0, math.radians(80), 0))
    check(render(scene), -0.11)


def test_outside_the_cone_counts_as_lit(scene):
    """All lies in shadow, and a spot's wide cone ends in the picture: its rim is a straight line there, nearly."""
    add_rectangle("Ground", -30, 30)
    add_rectangle("Plate", -30, 30, 10.0).visible_camera = False
    # Looks along -x from far above: the cone's lower side meets the ground at x = 0.11.
    half = math.radians(40)
    add_light("SPOT", (0.11, 0, 20), (0, half, 0), spot_size=2 * half)
    result = render(scene)
    expected = part_beyond(0.11)
    # The cone's rim on the ground is a parabola; over the picture's height it leaves the line by less than 0.08.
    sure = np.abs(part_beyond(0.11 - 0.08) - part_beyond(0.11 + 0.08)) < 1e-9
    np.testing.assert_array_equal(result.visibility[sure], np.round(expected[sure]))
    assert abs((result.visibility - expected).mean()) < 0.01


def test_behind_an_area_light_counts_as_lit(scene):
    """Upright over the ground it shines to +x; all before it lies in the shadow of a sheet just above the ground."""
    add_rectangle("Ground", -30, 30)
    add_rectangle("Plate", -30, 30, 0.1).visible_camera = False
    add_light("AREA", (-0.11, 0, 1.5), (0, -math.pi / 2, 0), size=0.3)
    check(render(scene), -0.11, flip=True)


@pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="light linking came with 4.0")
@pytest.mark.parametrize("slope", [0.0, 40.0])
def test_not_linked_counts_as_lit(scene, slope):
    """Also where it is turned away."""
    linked = add_rectangle("Left", -30, -0.11)
    add_rectangle("Right", -0.11, 30, 0, -slope * 30)
    add_rectangle("Plate", -30, 30, 10.0).visible_camera = False
    light = add_light("SUN", rotation=(0, -0.5, 0))
    receivers = bpy.data.collections.new("Receivers")
    receivers.objects.link(linked)
    light.light_linking.receiver_collection = receivers
    check(render(scene), -0.11)


# ---- housekeeping


@pytest.mark.parametrize(
    ("samples", "size", "grids"),
    [(64, (1280, 720), (4, 4)), (64, (1920, 1080), (3, 8)), (256, (640, 360), (8, 4)), (5, (40, 24), (1, 5)),
     (64, (16384, 16384), (1, 64)), (4, (40, 24), (1, 4))],
)  # fmt: skip
def test_grids_fit_the_picture(samples, size, grids):
    assert truth.choose_grids(samples, *size) == grids


def test_scene_is_left_as_it_was(scene):
    add_rectangle("Ground", -30, 30)
    add_light("AREA", shape="DISK", size=2.0)
    scene.cycles.seed, scene.cycles.samples, scene.cycles.pixel_filter_type = 7, 77, "BLACKMAN_HARRIS"
    render_settings = scene.render
    render_settings.resolution_x = 333
    counts = len(bpy.data.lights), len(bpy.data.materials)
    assert (render(scene, 8).visibility == 1).all()
    assert (scene.cycles.seed, scene.cycles.samples, scene.cycles.pixel_filter_type) == (7, 77, "BLACKMAN_HARRIS")
    assert (render_settings.resolution_x, len(bpy.data.lights), len(bpy.data.materials)) == (333, *counts)
