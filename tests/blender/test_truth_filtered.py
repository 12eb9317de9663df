# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The filtered truth of layers as the engine renders them: in their own maps; without a square, against Cycles."""

import importlib
import math

import bpy
import numpy as np
import pytest

WIDTH, HEIGHT = 96, 54
KINDS = {
    "SUN": {},
    "SPOT": {"spot_size": 1.2},
    "POINT": {},
    "AREA": {"size": 1.0},
}


@pytest.fixture
def modules(addon):
    names = ("batch_truth", "engine", "truth", "truth_store", "compare.light_squares")
    return {name: importlib.import_module(f"{addon.__name__}.{name}") for name in names}


@pytest.fixture
def scene(fresh_scene):
    """A turned light over a ground, with a plate between them whose straight edge passes below the light."""
    scene = fresh_scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.cycles.samples = 1
    add_rectangle("Ground", (-9, 9), (-9, 9), 0.0)
    plate = add_rectangle("Plate", (-8, 0), (-8, 8), 2.0)
    plate.visible_camera = False
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 2.4
    scene.camera = add("Camera", camera, (0, 0, 30))
    return scene


def add(name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    made.location, made.rotation_euler = location, rotation
    return made


def add_rectangle(name, x, y, z):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(x[0], y[0], z), (x[1], y[0], z), (x[1], y[1], z), (x[0], y[1], z)], [], [(0, 1, 2, 3)])
    return add(name, mesh)


def add_light(kind, turn=0.0):
    light = bpy.data.lights.new("Key", kind)
    for key, value in KINDS[kind].items():
        setattr(light, key, value)
    return add("Key", light, (0, 0, 6), (0, 0, turn))


def render(scene, modules, **parameters):
    """The captured frame of one layer of pcf."""
    settings = scene.shadow_layers
    settings.techniques, settings.samples = {"pcf"}, 1
    for name, value in parameters.items():
        setattr(settings if name == "map_size" else settings.pcf, name, value)
    with modules["engine"].capture(aux=("position", "normal", "ids")) as captured:
        bpy.ops.render.render()
    return captured.frames[0]


def filter_truth(scene, modules, frame, *, texels=0.0, world=0.0, samples=64):
    """At all pixels."""
    footprint = modules["compare.light_squares"].Footprint(texels, world)
    with modules["truth_store"].TruthStore(scene, scene.view_layers[0], frame.snapshot, enabled=False) as store:
        return store.get_filtered(frame, frame.layers[0], footprint, samples, frame.coverage > 0.5)[0]


@pytest.mark.parametrize("kind", KINDS)
def test_straight_edge_is_a_ramp_as_wide_as_the_square_in_the_map(scene, modules, kind):
    """The plate's edge lies below the light, so its shadow's edge is x = 0 on the ground, for each kind of light. The
    square's sides there follow from the layer's own views."""
    add_light(kind, turn=0.4)
    frame = render(scene, modules, map_size=256, kernel=3)
    layer = frame.layers[0]
    texels = 41.0
    found = filter_truth(scene, modules, frame, texels=texels, samples=256)
    (view,) = [view for view in layer.views if view["view_from_world"][2, 2] > 0.99]
    depth = 6.0 if view["perspective"] else 1.0
    sides = [texels * size * depth * view["view_from_world"][axis, :2] for axis, size in enumerate(view["texel_size"])]
    part = (np.arange(64) + 0.5) / 64 - 0.5
    across = (part[:, None] * sides[0][0] + part[None, :] * sides[1][0]).ravel()
    x = frame.aux["position"][0, :, 0] + frame.camera_position[0]
    expected = np.array([(place + across >= 0).mean() for place in x])
    inside = (expected > 0) & (expected < 1)
    assert 10 < inside.sum() < WIDTH
    error = found.visibility - expected
    assert np.abs(error).max() < 0.05
    reported = math.sqrt(np.mean(np.square(found.error[:, inside])))
    assert math.sqrt(np.mean(np.square(error[:, inside]))) < 2 * reported + 0.005 < 0.03
    assert (found.visibility[:, expected == 0] == 0).all() and (found.visibility[:, expected == 1] == 1).all()


@pytest.mark.parametrize("kind", KINDS)
def test_without_a_square_it_is_the_hard_truth(scene, modules, kind):
    """Two independent ways to the same mask: Cycles' rays, and the snapshot's triangles."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, radius=0.3, location=(0.4, 0.2, 0.3))
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(-0.6, -0.2, 0.7), rotation=(0.5, 0.3, 0.2))
    light = add_light(kind, turn=0.4)
    light.location.x, light.rotation_euler = 1.0, (0.2, 0.3, 0.4)
    frame = render(scene, modules, map_size=64)
    found = filter_truth(scene, modules, frame)
    with modules["truth"].CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        hard = cycles.render_light("Key")
    origin = np.array(frame.camera_position)
    if kind == "SUN":
        to_light = np.array(light.matrix_world.col[2][:3])
        sine = frame.aux["normal"] @ to_light
    else:
        to_light = np.array(light.location) - origin - frame.aux["position"]
        sine = np.einsum("ijk,ijk->ij", to_light, frame.aux["normal"]) / np.linalg.norm(to_light, axis=2)
    compared = hard.lit & (frame.coverage > 0.5) & (sine > 1e-3)
    assert compared.sum() > 3000 and (compared & ~hard.visible).sum() > 200
    assert ((found.visibility >= 0.5) != hard.visible)[compared].sum() <= 2
    assert set(np.unique(found.visibility)) == {0.0, 1.0} and found.error.max() == 0


def test_pcf_is_nearer_to_its_truth_than_to_the_hard_one(scene, modules):
    """Of the square of seven texels, not of another size: the truth that the descriptor names is the right one."""
    add_light("SPOT", turn=0.4)
    frame = render(scene, modules, map_size=128, kernel=7)
    layer = frame.layers[0]
    assert modules["batch_truth"].choose_kinds(["named", "hard", "filtered"], layer) == ["filtered", "hard"]
    errors = {
        texels: float(np.abs(filter_truth(scene, modules, frame, texels=texels).visibility - visibility).mean())
        for visibility in [layer.channels["visibility"]]
        for texels in (0.0, 5.0, 7.0, 9.0, 14.0)
    }
    assert min(errors, key=errors.get) == 7.0, errors
    assert errors[7.0] < 0.4 * errors[0.0]


def test_square_on_the_receiver(scene, modules):
    """A side of half a unit, whatever the map."""
    add_light("POINT")
    frame = render(scene, modules, map_size=64)
    found = filter_truth(scene, modules, frame, world=0.5, samples=256)
    x = frame.aux["position"][0, :, 0] + frame.camera_position[0]
    np.testing.assert_allclose(
        found.visibility, np.broadcast_to(np.clip(0.5 + x / 0.5, 0, 1), (HEIGHT, WIDTH)), atol=0.04
    )
