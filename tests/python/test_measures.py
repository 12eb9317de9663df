# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The measures against hand-made pictures, closed forms and brute force."""

import math
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

from compare import measures, pixels
from compare.border import BORDER_VALUES
from compare.distance import compute_nearest_distance
from compare.footprint import compute_sun_extent, compute_texel_footprint_px


def measure(layer, truth, comparable=None, **keywords):
    truth = np.asarray(truth, dtype=bool)
    comparable = np.ones(truth.shape, bool) if comparable is None else np.asarray(comparable, dtype=bool)
    return measures.measure_layer(np.asarray(layer, dtype=np.float32), truth, comparable, **keywords)


def test_border_pixels_have_a_compared_neighbour_across():
    lit = np.array([[1, 1, 1, 1], [1, 0, 0, 1], [1, 0, 0, 0]], bool)
    everywhere = np.ones(lit.shape, bool)
    # All but the corner above left and right, and below to the right, whose neighbours are like it.
    assert measures.count_border_pixels(lit, everywhere) == 9
    assert measures.count_border_pixels(lit, lit) == 0
    left = everywhere & (np.arange(4) < 2)
    assert measures.count_border_pixels(lit, left) == 5
    assert measures.count_border_pixels(np.zeros((3, 4), bool), everywhere) == 0


# ---- distances


@pytest.mark.parametrize("seed", range(6))
def test_nearest_distance_is_exact(seed):
    generator = np.random.default_rng(seed)
    height, width = generator.integers(1, 40, size=2)
    targets = generator.random((height, width)) < (0.002, 0.02, 0.5)[seed % 3]
    rows, columns = (axis.ravel() for axis in np.mgrid[0:height, 0:width])
    got = compute_nearest_distance(targets, rows, columns)
    target_rows, target_columns = np.nonzero(targets)
    if target_rows.size == 0:
        assert np.isinf(got).all()
        return
    squared = (rows[:, None] - target_rows) ** 2 + (columns[:, None] - target_columns) ** 2
    np.testing.assert_allclose(got, np.sqrt(squared.min(axis=1)), rtol=0, atol=1e-12)


def test_nearest_distance_without_targets_or_queries():
    assert np.isinf(compute_nearest_distance(np.zeros((3, 4), bool), np.array([1]), np.array([2]))).all()
    none = np.zeros(0, int)
    assert compute_nearest_distance(np.ones((3, 4), bool), none, none).shape == (0,)


# ---- the measures


def test_right_layer_has_no_error():
    truth = np.zeros((8, 8), bool)
    truth[:, 4:] = True
    result = measure(truth, truth)
    assert result.pixel_count == 64
    undefined = (*BORDER_VALUES, "border_mae")  # no border is given, and a hard truth has no pixels between
    assert all(value == 0.0 for name, value in result.values.items() if name not in undefined)
    assert all(result.values[name] is None for name in undefined)
    assert not result.faults.any()


def test_every_measure_has_a_value():
    assert set(measure(np.ones((2, 2)), np.ones((2, 2))).values) == {info.id for info in measures.MEASURES}


def test_border_moved_by_k_pixels():
    """A straight border that is k pixels off: closed forms for all measures."""
    height, width, border, moved = 50, 200, 80, 7
    truth = np.broadcast_to(np.arange(width) >= border, (height, width))
    layer = np.broadcast_to(np.arange(width) >= border - moved, (height, width))
    values = measure(layer, truth).values
    fraction = moved / width
    assert values["misclassified_fraction"] == pytest.approx(fraction)
    assert values["signed_bias"] == pytest.approx(fraction)
    assert values["mae"] == pytest.approx(fraction)
    assert values["rmse"] == pytest.approx(math.sqrt(fraction))
    # Wrong pixels lie 0.5, 1.5 ... 6.5 from the border in equal numbers, so 99 % reach the farthest.
    assert values["p99_border_distance_px"] == pytest.approx(moved - 0.5)
    # Distances 2.5 ... 6.5 are far.
    assert values["leak_fraction"] == pytest.approx((moved - 2) / width)
    assert values["acne_fraction"] == 0.0
    mirrored = measure(truth, layer).values
    assert mirrored["signed_bias"] == pytest.approx(-fraction)
    assert mirrored["acne_fraction"] == pytest.approx((moved - 2) / width)
    assert mirrored["leak_fraction"] == 0.0


def test_texels_widen_what_is_near():
    truth = np.broadcast_to(np.arange(100) >= 50, (10, 100))
    layer = np.broadcast_to(np.arange(100) >= 40, (10, 100))
    leak = [
        measure(layer, truth, footprint_px=lambda rows, columns, size=size: np.full(rows.shape, size)).values
        for size in (0.5, 1.0, 2.0, 4.75, 5.0, np.inf)
    ]
    # Far: distance (0.5, 1.5 ... 9.5) > max(2, 2 * size).
    assert [round(values["leak_fraction"] * 100) for values in leak] == [8, 8, 6, 0, 0, 0]
    assert {values["misclassified_fraction"] for values in leak} == {0.1}


def test_soft_values():
    truth = np.array([[1, 1, 0, 0]], bool)
    values = measure([[0.75, 0.5, 0.25, 0.5]], truth).values
    assert values["signed_bias"] == pytest.approx((-0.25 - 0.5 + 0.25 + 0.5) / 4)
    assert values["mae"] == pytest.approx(1.5 / 4)
    assert values["rmse"] == pytest.approx(math.sqrt((2 * 0.0625 + 2 * 0.25) / 4))
    assert values["misclassified_fraction"] == 0.25  # one half counts as lit


def test_border_mae_is_of_the_pixels_between_light_and_shadow():
    truth = np.array([[1.0, 0.75, 0.25, 0.0, 0.5, 1e-4]], np.float32)
    layer = np.array([[0.0, 0.5, 0.5, 1.0, 0.5, np.nan]], np.float32)
    comparable = np.ones(truth.shape, bool)
    values = measures.measure_layer(layer, truth, comparable).values
    assert values["border_mae"] == pytest.approx((0.25 + 0.25 + 0 + 1) / 4)
    comparable[0, 2:] = False
    assert measures.measure_layer(layer, truth, comparable).values["border_mae"] == pytest.approx(0.25)
    comparable[0, 1] = False
    assert measures.measure_layer(layer, truth, comparable).values["border_mae"] is None


def test_acne_is_speckle_far_from_shadow_and_leak_light_inside():
    truth = np.ones((60, 60), bool)
    truth[:, :30] = False
    layer = truth.astype(np.float32)
    layer[10, 50] = 0  # far out in the light
    layer[20, 30] = 0  # at the border
    layer[10, 5] = 1  # deep in the shadow
    layer[20, 29] = 1  # at the border
    result = measure(layer, truth)
    assert result.values["acne_fraction"] == pytest.approx(1 / 3600)
    assert result.values["leak_fraction"] == pytest.approx(1 / 3600)
    assert result.values["misclassified_fraction"] == pytest.approx(4 / 3600)
    assert result.faults[10, 50] == measures.ACNE and result.faults[10, 5] == measures.LEAK
    assert result.faults[20, 30] == measures.WRONG_SHADOW and result.faults[20, 29] == measures.WRONG_LIGHT


def test_leak_weight_counts_light_by_its_strength():
    """A faint glow over a whole shadow, to its border: deep pixels count with what they glow, those near it don't."""
    truth = np.broadcast_to(np.arange(60) >= 30, (40, 60))
    layer = np.where(truth, 1.0, 0.125)
    assert measure(layer, truth).values["leak_fraction"] == 0
    deep = 30 - 2  # distances 0.5 and 1.5 aren't far
    assert measure(layer, truth).values["leak_weight"] == pytest.approx(0.125 * deep * 40 / 2400)
    wide = measure(layer, truth, footprint_px=lambda rows, columns: np.full(rows.shape, 5.0)).values
    assert wide["leak_weight"] == pytest.approx(0.125 * (30 - 10) * 40 / 2400)
    soft = np.where(truth, 1.0, np.where(np.arange(60) >= 20, 0.01, 0.0))  # a penumbra, in which light is due
    assert measures.measure_layer(layer.astype(np.float32), soft, np.ones(soft.shape, bool)).values[
        "leak_weight"
    ] == pytest.approx(0.125 * (20 - 2) * 40 / 2400)
    assert measure(truth.astype(float), truth).values["leak_weight"] == 0
    assert measure(np.full((4, 4), 0.5), np.zeros((4, 4))).values["leak_weight"] == pytest.approx(0.5)


def test_false_shadow_at_the_dark_side_is_no_acne():
    truth = np.ones((20, 20), bool)
    comparable = np.ones((20, 20), bool)
    comparable[:, :10] = False
    layer = np.ones((20, 20), np.float32)
    layer[5, 10] = 0
    assert measure(layer, truth, comparable).values["acne_fraction"] == pytest.approx(1 / 200)
    assert measure(layer, truth, comparable, facing_away=~comparable).values["acne_fraction"] == 0


def test_false_shadow_without_any_true_shadow_is_acne_and_has_no_distance():
    layer = np.ones((10, 10), np.float32)
    layer[3, 3] = 0
    values = measure(layer, np.ones((10, 10))).values
    assert values["acne_fraction"] == pytest.approx(0.01)
    assert values["p99_border_distance_px"] is None


def test_excluded_pixels_count_nowhere():
    truth = np.zeros((4, 4), bool)
    comparable = np.zeros((4, 4), bool)
    comparable[0] = True
    result = measure(np.where(comparable, 0, 1), truth, comparable)
    assert result.pixel_count == 4
    assert result.values["misclassified_fraction"] == 0 and result.values["mae"] == 0
    nothing = measure(np.ones((4, 4)), truth, np.zeros((4, 4)))
    assert nothing.pixel_count == 0 and set(nothing.values.values()) == {None}


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_values_that_are_not_finite_are_errors(bad):
    for truth in (True, False):
        values = measure(np.full((2, 2), bad), np.full((2, 2), truth)).values
        assert values["misclassified_fraction"] == 1 and values["mae"] == 1 and values["rmse"] == 1


def test_sizes_that_differ_are_refused():
    with pytest.raises(ValueError, match=r"\(2, 3\).*same resolution"):
        measure(np.ones((2, 3)), np.ones((2, 2)))


def test_p99_takes_the_ninety_ninth_of_a_hundred():
    assert measures.compute_p99(np.arange(1.0, 101.0)) == 99.0
    assert measures.compute_p99(np.array([4.0])) == 4.0


# ---- comparable pixels


def look_down(width=8, height=8, *, z=10.0, perspective=True, extent=1.0, origin=(0.0, 0.0)):
    """A camera at height z over `origin` that looks straight down, its window 2 * extent wide."""
    matrix = np.eye(4)
    matrix[:3, 3] = (*origin, z)
    camera = SimpleNamespace(
        perspective=perspective, window=(-extent, extent, -extent, extent), world_from_camera=matrix
    )
    x = (np.arange(width) + 0.5) / width * 2 * extent - extent
    y = (np.arange(height) + 0.5) / height * 2 * extent - extent
    scale = z if perspective else 1.0
    positions = np.zeros((height, width, 3))
    positions[..., 0], positions[..., 1] = np.meshgrid(x * scale, y * scale)
    positions[..., 2] = -z
    return camera, positions


def make_light(kind="POINT", location=(0.0, 0.0, 5.0), **keywords):
    matrix = np.eye(4)
    matrix[:3, 3] = location
    fields = {"spot_angle": 0.8, "spot_scale": (1.0, 1.0), "receiver_set": pixels.ALL_GROUPS, **keywords}
    return SimpleNamespace(kind=kind, world_from_light=matrix, **fields)


def classify(camera, positions, light, *, others=None, covered=None, normals=None, lit=None):
    height, width = positions.shape[:2]
    covered = np.ones((height, width), bool) if covered is None else covered
    normals = np.broadcast_to([0.0, 0.0, 1.0], positions.shape) if normals is None else normals
    return pixels.classify_pixels(
        pixels.Surface(positions, covered),
        pixels.Surface(positions if others is None else others, covered),
        normals,
        np.ones((height, width), bool) if lit is None else lit,
        camera=camera,
        width=width,
        height=height,
        light=light,
    )


def test_background_and_other_surfaces_are_excluded():
    camera, positions = look_down()
    covered = np.ones((8, 8), bool)
    covered[0] = False
    others = positions.copy()
    pixel_size = 10 * 2 / 8
    others[1, :, 2] += 1.02 * pixels.SURFACE_TOLERANCE_PX * pixel_size
    others[2, :, 2] += 0.98 * pixels.SURFACE_TOLERANCE_PX * pixel_size
    others[3, :, 0] += pixel_size  # along the face: still the same plane
    classes = classify(camera, positions, make_light(), others=others, covered=covered)
    assert classes.count_excluded() == {
        "background": 8,
        "not_same_surface": 8,
        "faces_away": 0,
        "outside_cone": 0,
        "not_linked": 0,
        "unlit": 0,
    }
    assert classes.comparable.sum() == 48


def test_covered_by_one_only_is_not_the_same_surface():
    camera, positions = look_down(2, 1)
    ours = pixels.Surface(positions, np.array([[True, False]]))
    truth = pixels.Surface(positions, np.array([[False, False]]))
    normals = np.broadcast_to([0.0, 0.0, 1.0], positions.shape)
    classes = pixels.classify_pixels(
        ours, truth, normals, np.ones((1, 2), bool), camera=camera, width=2, height=1, light=make_light()
    )
    assert [pixels.EXCLUSION_CAUSES[cause] for cause in classes.cause[0]] == ["not_same_surface", "background"]


def test_far_from_the_origin_rounding_does_not_exclude():
    """Float32 positions 1e5 from the origin are 0.004 off; pixels here are 0.0025 wide."""
    camera, positions = look_down(extent=0.001, origin=(1e5, 1e5))
    world = positions + np.array([1e5, 1e5, 10.0])
    others = world.astype(np.float32).astype(np.float64) - np.array([1e5, 1e5, 10.0])
    others[..., 2] += 0.004
    light = make_light(location=(1e5, 1e5, 5.0))
    assert classify(camera, positions, light, others=others).comparable.all()


def test_spot_cone_matches_its_circle():
    camera, positions = look_down(200, 200)
    light = make_light("SPOT", location=(1.0, -2.0, 4.0), spot_angle=1.2)
    classes = classify(camera, positions, light)
    radius = np.hypot(positions[..., 0] - 1.0, positions[..., 1] + 2.0)
    expected = radius < 4.0 * math.tan(0.6) * (1 - 1e-4)
    uncertain = np.abs(radius - 4.0 * math.tan(0.6)) < 1e-3
    assert np.array_equal(classes.comparable[~uncertain], expected[~uncertain])
    assert classes.count_excluded()["outside_cone"] == 200 * 200 - classes.comparable.sum()


def test_sun_and_back_faces():
    camera, positions = look_down()
    up = make_light("SUN")
    assert classify(camera, positions, up).comparable.all()
    tilted = np.broadcast_to([math.cos(1e-4), 0.0, math.sin(1e-4)], positions.shape)
    assert classify(camera, positions, up, normals=tilted).facing_away.all()
    behind = make_light("AREA", location=(0.0, 0.0, -1.0))
    assert classify(camera, positions, behind).facing_away.all()


def test_light_that_cycles_does_not_send_is_named():
    camera, positions = look_down()
    lit = np.ones((8, 8), bool)
    lit[0, :3] = False
    assert classify(camera, positions, make_light(), lit=lit).count_excluded()["unlit"] == 3
    linked = make_light(receiver_set=0xFF)
    assert classify(camera, positions, linked, lit=lit).count_excluded()["not_linked"] == 3


# ---- texel footprints


def footprint(camera, positions, light, map_size, *, normals=None, sun_extent=0.0, size=8):
    flat = positions.reshape(-1, 3)
    normals = np.broadcast_to([0.0, 0.0, 1.0], flat.shape) if normals is None else normals
    origin = camera.world_from_camera[:3, 3]
    return compute_texel_footprint_px(
        flat,
        normals,
        origin,
        camera=camera,
        width=size,
        height=size,
        light=light,
        map_size=map_size,
        sun_extent=sun_extent,
    )


def test_sun_footprint_on_a_plane_seen_from_above():
    for perspective, extent in ((True, 1.0), (False, 10.0)):
        camera, positions = look_down(perspective=perspective, extent=extent)
        # The picture shows 20 x 20 units in 8 x 8 pixels; the map 20 units in 100 texels.
        got = footprint(camera, positions, make_light("SUN"), 100, sun_extent=20.0)
        np.testing.assert_allclose(got, 8 / 100)


def test_sun_at_an_angle_stretches_the_texel():
    camera, positions = look_down(perspective=False, extent=10.0)
    light = make_light("SUN")
    angle = 1.1
    light.world_from_light = np.array(
        [
            [math.cos(angle), 0, math.sin(angle), 0],
            [0, 1, 0, 0],
            [-math.sin(angle), 0, math.cos(angle), 0],
            [0, 0, 0, 1],
        ]
    )
    got = footprint(camera, positions, light, 100, sun_extent=20.0)
    np.testing.assert_allclose(got, 8 / 100 / math.cos(angle))


def test_sun_extent_is_that_of_the_receivers():
    _, positions = look_down(100, 50)
    extent = compute_sun_extent(positions.reshape(-1, 3), np.array([0.0, 0.0, 10.0]), make_light("SUN"))
    assert extent == pytest.approx(20 * 0.99)


@pytest.mark.parametrize("kind", ["SPOT", "POINT", "AREA"])
def test_local_light_footprint_grows_with_distance(kind):
    camera, positions = look_down()
    for height in (2.0, 5.0):
        angle = 0.9 if kind == "SPOT" else math.pi / 2
        light = make_light(kind, location=(0.0, 0.0, height), spot_angle=angle)
        centre = np.abs(positions.reshape(-1, 3)[:, :2]).max(axis=1) < 2.0
        got = footprint(camera, positions, light, 256)[centre]
        texel = 2 * height * math.tan(angle / 2) / 256
        np.testing.assert_allclose(got, texel * 8 / 20)


def test_footprint_against_finite_differences():
    """A slanted face in perspective under a point light: the stretch of a small circle of texel steps."""
    camera, _ = look_down(size := 8, size)
    normal = np.array([0.3, -0.2, 0.9])
    normal /= np.linalg.norm(normal)
    point_ws = np.array([1.0, 0.5, 0.2])
    light = make_light("POINT", location=(-1.0, 2.0, 3.0))
    camera_ws, light_ws = np.array([0.0, 0.0, 10.0]), np.array([-1.0, 2.0, 3.0])

    def pixel(p):
        v = p - camera_ws
        return np.array([v[0] / -v[2], v[1] / -v[2]]) * 4

    def texel(p):
        v = p - light_ws  # here -z is the longest axis
        return np.array([v[0] / -v[2], v[1] / -v[2]]) * 128

    tangent = np.cross(normal, [0.0, 0.0, 1.0])
    tangent /= np.linalg.norm(tangent)
    other = np.cross(normal, tangent)
    step = 1e-6
    longest = 0.0
    for angle in np.linspace(0, math.pi, 2001):
        delta = (tangent * math.cos(angle) + other * math.sin(angle)) * step
        pixels_moved = np.linalg.norm(pixel(point_ws + delta) - pixel(point_ws - delta))
        longest = max(longest, pixels_moved / np.linalg.norm(texel(point_ws + delta) - texel(point_ws - delta)))
    got = footprint(camera, (point_ws - camera_ws)[None], light, 256, normals=normal[None], size=size)
    np.testing.assert_allclose(got, longest, rtol=1e-4)


def test_light_along_the_face_has_no_finite_footprint():
    camera, positions = look_down(perspective=False, extent=10.0)
    sideways = np.broadcast_to([1.0, 0.0, 0.0], (64, 3))
    assert np.isinf(footprint(camera, positions, make_light("SUN"), 100, normals=sideways, sun_extent=20.0)).all()
