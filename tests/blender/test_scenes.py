# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The generators of test_scenes/: what they promise, the same every time, and rendered to layers that hold shadows."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector

# name: (fewest triangles, most triangles, kinds of its lights)
kScenes = {
    "box": (14, 14, {"SPOT"}),
    "jenga": (17_600, 18_000, {"SPOT"}),
    "hall": (500_000, 510_000, {"SUN"}),
    "fence": (100_000, 200_000, {"SUN"}),
    "studio": (150_000, 250_000, {"SUN", "SPOT", "POINT", "AREA"}),
    "city": (1_000_000, 2_000_000, {"SUN"}),
    "knot": (99_000, 101_000, {"SPOT"}),
    "wall": (41_000, 42_000, {"SPOT"}),
    "door": (37_000, 39_000, {"SPOT"}),
    "blades": (218, 218, {"SUN"}),
    "bumpy": (961_752, 961_752, {"SUN"}),
}


def render_small(scene, width=160, *, aux=(), map_size=256, techniques=("sm",)):
    """The captured frame of the scene at `width` pixels, 16:9."""
    from addon import engine

    scene.render.engine = "SHADOW_LAYERS"
    scene.render.resolution_x, scene.render.resolution_y = width, width * 9 // 16
    scene.shadow_layers.map_size = map_size
    scene.shadow_layers.techniques = set(techniques)
    with engine.capture(aux=aux) as captured:
        bpy.ops.render.render()
    assert not captured.errors
    return captured.frames[0]


def count_triangles(snapshot) -> int:
    sizes = np.array([len(mesh.triangles) for mesh in snapshot.meshes])
    return int(sizes[snapshot.instance_mesh].sum())


@pytest.mark.parametrize("name", kScenes)
def test_scene_holds_what_it_promises_and_renders(open_scene, name):
    scene = open_scene(name)
    assert (scene.render.resolution_x, scene.render.resolution_y) == (1280, 720)
    frame = render_small(scene)
    fewest, most, kinds = kScenes[name]
    assert fewest <= count_triangles(frame.snapshot) <= most
    assert {light.kind for light in frame.snapshot.lights} == kinds
    assert len(frame.layers) == len(kinds)
    seen = frame.coverage > 0.5
    assert seen.mean() > 0.3
    for layer in frame.layers:
        visibility = layer.channels["visibility"][seen]
        assert np.isfinite(visibility).all() and visibility.min() >= 0 and visibility.max() <= 1
        assert (visibility > 0.5).mean() > 0.02, f"{layer.light} lights next to nothing"
        assert (visibility < 0.5).mean() > 0.02, f"{layer.light} casts next to no shadow"


def light_from_all_kinds(scene) -> float:
    """Puts seven lights of all kinds and shapes in the place of the scene's own, in the first one's direction, each as
    wide as 0.2 of its distance. Returns the distance."""
    lights = [thing for thing in scene.objects if thing.type == "LIGHT"]
    turned = lights[0].matrix_world.to_3x3().normalized().to_4x4()
    for light in lights:
        bpy.data.objects.remove(light)
    bpy.context.view_layer.update()
    corners = [thing.matrix_world @ Vector(corner) for thing in scene.objects if thing.type == "MESH"
               for corner in thing.bound_box]  # fmt: skip
    low, high = (Vector(pick(c[axis] for c in corners) for axis in range(3)) for pick in (min, max))
    distance = 0.6 * (high - low).length
    turned.translation = (low + high) / 2 + distance * turned.col[2].to_3d()
    for name in ("SUN", "SPOT", "POINT", "RECTANGLE", "ELLIPSE", "DISK", "SQUARE"):
        is_area = name in {"RECTANGLE", "ELLIPSE", "DISK", "SQUARE"}
        data = bpy.data.lights.new(name, "AREA" if is_area else name)
        if is_area:
            data.shape, data.size, data.size_y = name, 0.2 * distance, 0.1 * distance
        elif name == "SUN":
            data.angle = 0.2
        else:
            data.shadow_soft_size = 0.1 * distance
        thing = bpy.data.objects.new(name, data)
        scene.collection.objects.link(thing)
        thing.matrix_world = turned
    return distance


def take_layers(frame, technique: str) -> dict:
    return {layer.light: layer.channels["visibility"] for layer in frame.layers if layer.technique == technique}


@pytest.mark.parametrize("name", kScenes)
def test_soft_is_the_mean_of_hard_layers_under_every_kind_of_light(open_scene, name):
    scene = open_scene(name)
    light_from_all_kinds(scene)
    settings = scene.shadow_layers
    settings.soft.light_samples, settings.soft.pattern = 8, "fixed"
    settings.multi.positions, settings.multi.technique = 8, "exact"
    frame = render_small(scene, techniques=("soft", "multi"))
    soft, mean = (take_layers(frame, technique) for technique in ("soft", "multi"))
    assert len(soft) == 7 and soft.keys() == mean.keys()
    for light, layer in soft.items():
        assert np.abs(layer - mean[light]).max() < 2e-5, light  # the rounding of the sums
        assert ((layer > 0.01) & (layer < 0.99)).sum() > 50, f"{light} has next to no penumbra"
    settings.soft.light_samples = 1
    frame = render_small(scene, techniques=("soft", "exact"))
    one, hard = (take_layers(frame, technique) for technique in ("soft", "exact"))
    for light, layer in one.items():
        assert np.array_equal(layer, hard[light]), light


@pytest.mark.parametrize("kind", ["spot", "sun", "point", "area"])
def test_box_shadow_has_the_outline_of_the_closed_form(open_scene, kind):
    """A ray from each point of the plane to the light meets the cube or not: the slab test says which."""
    scene = open_scene("box", "--light", kind)
    frame = render_small(scene, 320, aux=("position",), map_size=1024, techniques=("edsm",))
    light, cube = scene.objects["Key"], scene.objects["Cube"]
    place = frame.aux["position"].astype(np.float64) + np.array(frame.camera_position)
    on_plane = (frame.coverage > 0.5) & (np.abs(place[..., 2]) < 1e-4)
    into_cube = np.array(cube.matrix_world.inverted())
    start = place[on_plane] @ into_cube[:3, :3].T + into_cube[:3, 3]
    if kind == "sun":
        towards = np.broadcast_to(np.array(light.matrix_world.to_3x3())[:, 2], start.shape)
    else:
        towards = np.array(light.matrix_world.translation) - place[on_plane]
    ray = towards @ into_cube[:3, :3].T
    half = np.array(cube.dimensions) / 2
    with np.errstate(divide="ignore"):
        near, far = (-half - start) / ray, (half - start) / ray
    enters, leaves = np.minimum(near, far).max(axis=1), np.maximum(near, far).min(axis=1)
    lit = ~((enters < leaves) & (leaves > 0))
    if kind == "spot":  # outside its cone everything counts as lit
        axis = -np.array(light.matrix_world.to_3x3())[:, 2]
        inside = -(towards @ axis) / np.linalg.norm(towards, axis=1) > math.cos(light.data.spot_size / 2)
        lit |= ~inside
    wrong = (frame.layers[0].channels["visibility"][on_plane] > 0.5) != lit
    assert 0.03 < 1 - lit.mean() < 0.5
    assert wrong.mean() < 2e-3


@pytest.mark.parametrize("wanted", [100, 15_000, 200_000])
def test_knot_has_about_the_triangles_asked_for_and_is_closed(open_scene, wanted):
    open_scene("knot", "--triangles", str(wanted))
    mesh = bpy.data.meshes["Knot"]
    assert abs(2 * len(mesh.polygons) - wanted) < 0.05 * wanted
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    quads = corners.reshape(-1, 4)
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses == 2).all(), "every edge joins two faces"
    # The tube comes back to where it began without a twist: edges along it stay short.
    place = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", place)
    place = place.reshape(-1, 3)
    lengths = np.linalg.norm(place[edges[:, 0]] - place[edges[:, 1]], axis=1)
    assert lengths.max() < 6 * np.median(lengths)


def test_knot_refuses_too_few_triangles(run_script, project_root, tmp_path):
    out = tmp_path / "out.blend"
    done = run_script(project_root / "test_scenes" / "knot.py", [str(out), "--triangles", "5"], check=False)
    assert done.returncode == 1 and "--triangles 5" in done.stdout + done.stderr
    assert not out.exists()


def test_the_walls_shadow_meets_the_statues(open_scene):
    """What the scene is for: its shadow ends on the statue and on the floor."""
    frame = render_small(open_scene("wall"), 320, aux=("ids",), map_size=1024, techniques=("edsm",))
    names = frame.snapshot.instance_names
    seen = frame.aux["ids"][..., 0]
    lit = frame.layers[0].channels["visibility"] > 0.5
    for name in ("Floor", "Statue"):
        share = lit[seen == names.index(name)].mean()
        assert 0.1 < share < 0.9, name


@pytest.mark.parametrize(("size", "small"), [((1280, 720), 0.8), ((800, 600), 0.99)])
def test_bumpy_has_triangles_smaller_than_pixels(open_scene, size, small):
    """What the scene is for: most cover less than a pixel, and the nearest lie within 4 x 4."""
    scene = open_scene("bumpy")
    mesh, camera = bpy.data.meshes["Field"], scene.camera
    place = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", place)
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    quads = corners.reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    matrix = np.array(camera.matrix_world.inverted())
    points = place.reshape(-1, 3).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    assert points[:, 2].max() < 0
    wide = size[0] / (2 * math.tan(camera.data.angle / 2))  # pixels at distance 1
    pixels = points[:, :2] / -points[:, 2:] * wide
    seen = (np.abs(pixels) < np.array(size) / 2).all(axis=1)[triangles].any(axis=1)
    across = pixels[triangles[seen]]
    a, b = (across[:, k] - across[:, 0] for k in (1, 2))
    areas = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert (areas < 1).mean() > small
    assert (across.max(axis=1) - across.min(axis=1)).max() < 4
    assert seen.mean() > 0.9


@pytest.mark.parametrize("options", [(), ("--light", "spot")])
def test_bumpy_without_bumps_is_flat_and_holds_the_same_shadow(open_scene, options):
    frame = render_small(open_scene("bumpy", "--bumps", "0", "--hide-grille", *options), 320, aux=("position",))
    seen = frame.coverage == 1  # by all samples of the pixel; positions are the first one's
    height = frame.aux["position"][..., 2][seen] + frame.camera_position[2]
    assert np.abs(height).max() < 1e-5
    assert 0.02 < (frame.layers[0].channels["visibility"][seen] < 0.5).mean() < 0.4


def test_bumpy_refuses_heights_that_are_none(run_script, project_root, tmp_path):
    out = tmp_path / "out.blend"
    done = run_script(project_root / "test_scenes" / "bumpy.py", [str(out), "--bumps", "-1"], check=False)
    assert done.returncode == 1 and "--bumps -1" in done.stdout + done.stderr
    assert not out.exists()


def test_city_shares_its_meshes(open_scene):
    snapshot = render_small(open_scene("city")).snapshot
    assert len(snapshot.meshes) < 50
    assert len(snapshot.instance_mesh) > 200


def test_studio_moves_without_changing_its_topology(open_scene):
    scene = open_scene("studio")
    first = render_small(scene, 64).snapshot
    scene.frame_set(25)
    later = render_small(scene, 64).snapshot
    scene.frame_set(1 + 48)
    again = render_small(scene, 64).snapshot
    figures = [
        snapshot.meshes[snapshot.instance_mesh[snapshot.instance_names.index("Mannequin")]]
        for snapshot in (first, later, again)
    ]
    assert np.array_equal(figures[0].triangles, figures[1].triangles)
    moved = np.linalg.norm(figures[0].positions - figures[1].positions, axis=1)
    assert 0.3 < moved.max() < 2.0
    assert np.allclose(figures[0].positions, figures[2].positions, atol=1e-5)  # it loops


def test_generators_give_the_same_scene_every_time(addon, run_script, project_root, tmp_path):
    """Every random number comes from a seeded generator: two runs, one scene."""
    snapshots = []
    for turn in range(2):
        path = tmp_path / f"{turn}.blend"
        run_script(project_root / "test_scenes" / "fence.py", [str(path)])
        bpy.ops.wm.open_mainfile(filepath=str(path))
        snapshots.append(render_small(bpy.context.scene, 64).snapshot)
    for one, other in zip(snapshots[0].meshes, snapshots[1].meshes, strict=True):
        assert np.array_equal(one.positions, other.positions) and np.array_equal(one.triangles, other.triangles)
    assert np.array_equal(snapshots[0].instance_matrix, snapshots[1].instance_matrix)


def write_obj(path, text):
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_model_reads_polygons_and_corners_with_slashes(open_scene, tmp_path):
    """A pyramid: a square below (two triangles) and four sides, corners written as v/vt/vn."""
    text = "# pyramid\nv 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\nv 1 3 1\nvn 0 1 0\nf 1/1/1 2/2/1 3/3/1 4/4/1\n"
    text += "f 1//1 2//1 5//1\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
    scene = open_scene("model", "--obj", write_obj(tmp_path / "pyramid.obj", text))
    mesh = bpy.data.meshes["pyramid"]
    heights = [vertex.co.z for vertex in mesh.vertices]
    assert len(mesh.polygons) == 6
    assert min(heights) == pytest.approx(0, abs=1e-6) and max(heights) == pytest.approx(2.0)
    assert count_triangles(render_small(scene, 64).snapshot) == 6 + 2


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("v 0 0 0\n", "0 faces"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", "vertex 7"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n", "negative"),
    ],
)
def test_model_refuses_what_it_cannot_read(run_script, project_root, tmp_path, text, reason):
    out = tmp_path / "out.blend"
    arguments = [str(out), "--obj", write_obj(tmp_path / "bad.obj", text)]
    done = run_script(project_root / "test_scenes" / "model.py", arguments, check=False)
    assert done.returncode == 1
    assert reason in done.stdout + done.stderr
    assert not out.exists()
