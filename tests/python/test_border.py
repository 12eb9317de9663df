# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shift and staircase of borders against edges known in closed form."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parent))

from analytic_edges import (
    HEIGHT,
    WIDTH,
    draw_layer,
    draw_truth,
    edge_coordinates,
    measure_edge,
    sample_centres,
    sawtooth,
    texels_of,
    triangle,
)
from compare import border, contour, true_border
from compare.distance import find_nearest_target

SAMPLES = 3
ROOT_12 = math.sqrt(12.0)


# ---- the contour


def draw_disc(samples, radius, size=(60, 50)):
    x, y = sample_centres(*size, samples)
    return (x - 30.2) ** 2 + (y - 24.7) ** 2 < radius**2


@pytest.mark.parametrize("samples", [2, 3, 4, 5])
def test_contour_of_a_disc_lies_on_its_circle(samples):
    found = contour.trace_contour(draw_disc(samples, 18.3), samples)
    to_middle = np.array([30.2, 24.7]) - found.middles
    radius = np.linalg.norm(to_middle, axis=1)
    assert np.abs(radius - 18.3).max() < 0.5 / samples
    assert np.sqrt(np.mean((radius - 18.3) ** 2)) < 0.2 / samples
    assert found.lengths_px.sum() == pytest.approx(2 * math.pi * 18.3, rel=0.02)
    inwards = np.einsum("ij,ij->i", found.normals, to_middle) / radius
    assert inwards.min() > 0.8  # towards the larger values, which are inside


def test_contour_of_a_smooth_truth_is_exact_on_straight_edges():
    along, across = edge_coordinates(*sample_centres(WIDTH, HEIGHT), 23.0)
    found = contour.trace_contour(np.clip(0.5 - across / 9.0, 0.0, 1.0))
    distance = edge_coordinates(*found.starts.T, 23.0)[1]
    assert np.abs(distance).max() < 1e-4
    assert len(found.starts) > WIDTH and along.shape == (HEIGHT, WIDTH)


@pytest.mark.parametrize("middle", [0.0, 1.0])
def test_saddles_are_cut_by_their_middle(middle):
    """Two corners above and two below: the pieces part the corners that the middle doesn't join."""
    corners = np.array([[0.5, -0.3, 0.5, -0.3]]) if middle else np.array([[0.3, -0.5, 0.3, -0.5]])
    cells, starts, ends = contour.cut_cells(corners)
    assert cells.tolist() == [0, 0]
    joined = {(0, 0), (1, 1)} if middle else {(1, 0), (0, 1)}
    for start, end in zip(starts, ends, strict=True):
        # The corner that a piece cuts off is the nearest one, and not one of those that the middle joins.
        corner = tuple(np.round(0.5 * (start + end)).astype(int))
        assert corner not in joined


def test_contour_of_nothing():
    for picture in (
        np.ones((5, 5), bool),
        np.zeros((5, 5), np.float32),
        np.ones((1, 1), bool),
        np.full((3, 3), np.nan),
    ):
        assert len(contour.trace_contour(picture, 1).starts) == 0


def test_nearest_target_is_the_one_of_brute_force():
    generator = np.random.default_rng(7)
    targets = generator.random((30, 41)) < 0.01
    rows, columns = (axis.ravel() for axis in np.mgrid[0:30, 0:41])
    distance, near_rows, near_columns = find_nearest_target(targets, rows, columns)
    assert targets[near_rows, near_columns].all()
    np.testing.assert_allclose(np.hypot(near_rows - rows, near_columns - columns), distance)
    limited, limited_rows, _ = find_nearest_target(targets, rows, columns, 5.0)
    np.testing.assert_array_equal(limited, np.where(distance <= 5.0, distance, np.inf))
    assert ((limited_rows == -1) == (distance > 5.0)).all()


# ---- shift and staircase


@pytest.mark.parametrize("angle", [2.0, 11.0, 31.0, 42.0, 63.0, 127.0, 260.0])
@pytest.mark.parametrize("shift", [0.0, 0.4, 1.7, -0.9])
def test_moved_edge_has_its_shift_and_no_staircase(angle, shift):
    values = measure_edge(draw_layer(angle, shift), draw_truth(angle, SAMPLES), SAMPLES).values
    assert values["border_bias_px"] == pytest.approx(shift, abs=0.07)
    assert values["staircase_px"] < 0.12 and values["unbiased_error_px"] < 0.12
    assert values["border_bias_texels"] is None and values["staircase_texels"] is None
    assert values["unpaired_fraction"] == 0


@pytest.mark.parametrize("wave", [sawtooth, triangle])
@pytest.mark.parametrize("rms", [0.29, 0.8, 1.6])
@pytest.mark.parametrize(("angle", "shift"), [(5.0, 0.0), (22.0, 0.5), (40.0, -1.0), (-71.0, 0.3)])
def test_sawtooth_has_its_rms(wave, rms, angle, shift):
    texel_px = 4.0
    layer = draw_layer(angle, shift, lambda along: wave(along, 19.7, rms * ROOT_12))
    values = measure_edge(layer, draw_truth(angle, SAMPLES), SAMPLES, texels=texels_of(texel_px)).values
    assert values["staircase_px"] == pytest.approx(rms, abs=0.06)
    assert values["border_bias_px"] == pytest.approx(shift, abs=0.1)
    assert values["staircase_texels"] == pytest.approx(values["staircase_px"] / texel_px)
    assert values["border_bias_texels"] == pytest.approx(values["border_bias_px"] / texel_px)
    # Evenly spread over its height: the mean of |d| is a quarter of it.
    assert values["unbiased_error_px"] == pytest.approx(rms * ROOT_12 / 4, abs=0.06)


def test_layer_of_a_coarse_map_has_the_staircase_of_its_texels():
    """A hard map of texels of 5 pixels, its grid turned: 0.29 texels and no shift; smoothed half a texel outwards,
    the shift without the staircase, though more of its area is wrong."""
    angle, texel_px, grid = 12.0, 5.0, math.radians(29.0)
    x, y = sample_centres(WIDTH, HEIGHT)
    u, v = (x * math.cos(grid) + y * math.sin(grid)) / texel_px, (y * math.cos(grid) - x * math.sin(grid)) / texel_px
    u, v = (np.floor(u) + 0.5) * texel_px, (np.floor(v) + 0.5) * texel_px
    centre_x, centre_y = u * math.cos(grid) - v * math.sin(grid), u * math.sin(grid) + v * math.cos(grid)
    stepped = (edge_coordinates(centre_x, centre_y, angle)[1] < 0).astype(np.float32)
    truth = draw_truth(angle, SAMPLES)
    plain = measure_edge(stepped, truth, SAMPLES, texels=texels_of(texel_px)).values
    smooth = measure_edge(draw_layer(angle, -0.5 * texel_px), truth, SAMPLES, texels=texels_of(texel_px)).values
    assert plain["staircase_texels"] == pytest.approx(1 / ROOT_12, abs=0.04)
    assert abs(plain["border_bias_texels"]) < 0.03
    assert smooth["staircase_texels"] < 0.02 and smooth["border_bias_texels"] == pytest.approx(-0.5, abs=0.01)


def test_shift_in_texels_is_taken_across_the_border():
    """Texels twice as wide as high: the same shift of an edge is other numbers of texels by the edge's direction."""

    def texels(rows, columns):
        return np.broadcast_to(np.diag([6.0, 3.0]), (len(rows), 2, 2))

    for angle, texel_px in ((0.4, 3.0), (90.4, 6.0)):
        values = measure_edge(draw_layer(angle, 1.5), draw_truth(angle, SAMPLES), SAMPLES, texels=texels).values
        assert values["border_bias_texels"] == pytest.approx(1.5 / texel_px, abs=0.05)
    normal = np.array([-math.sin(math.radians(35.0)), math.cos(math.radians(35.0))])
    texel_px = np.linalg.norm(np.diag([6.0, 3.0]) @ normal)
    values = measure_edge(draw_layer(35.0, 1.5), draw_truth(35.0, SAMPLES), SAMPLES, texels=texels).values
    assert values["border_bias_texels"] == pytest.approx(1.5 / texel_px, abs=0.02)


def test_texels_that_grow_over_the_picture_are_no_staircase():
    """Half a texel everywhere, of texels from 2 to 8 pixels: a shift and nothing else."""
    x, y = sample_centres(WIDTH, HEIGHT)
    along, across = edge_coordinates(x, y, 0.7)

    def get_texel_px(along):
        return 5.0 + 3.0 * along / (WIDTH / 2)

    layer = (across < 0.5 * get_texel_px(along)).astype(np.float32)

    def texels(rows, columns):
        sizes = get_texel_px(edge_coordinates(columns + 0.5, rows + 0.5, 0.7)[0])
        return sizes[:, None, None] * np.eye(2)

    values = measure_edge(layer, draw_truth(0.7, SAMPLES), SAMPLES, texels=texels).values
    assert values["border_bias_texels"] == pytest.approx(0.5, abs=0.03)
    assert values["staircase_texels"] < 0.04 and values["staircase_px"] < 0.15
    assert values["border_bias_px"] == pytest.approx(2.5, abs=0.1)


def test_limit_is_taken_across_the_border():
    """Texels of 40 x 1 pixels along a border: a patch 6 pixels deep is a leak there, and no part of its staircase."""

    def texels(rows, columns):
        return np.broadcast_to(np.diag([40.0, 1.0]), (len(rows), 2, 2))

    layer = draw_layer(0.6, 0.0)
    x, y = sample_centres(WIDTH, HEIGHT)
    _, across = edge_coordinates(x, y, 0.6)
    layer[(across < 6.0) & (np.abs(x - 200.0) < 15.0)] = 1.0
    found = measure_edge(layer, draw_truth(0.6, SAMPLES), SAMPLES, texels=texels)
    assert found.values["staircase_px"] < 0.5
    assert found.lengths_px["unpaired"] == pytest.approx(26.0, abs=6.0)


def test_soft_layer_counts_by_its_half():
    _, across = edge_coordinates(*sample_centres(WIDTH, HEIGHT), 33.0)
    layer = np.clip(0.5 - (across - 0.6) / 12.0, 0.0, 1.0)
    values = measure_edge(layer, draw_truth(33.0, SAMPLES), SAMPLES).values
    assert values["border_bias_px"] == pytest.approx(0.6, abs=0.05) and values["staircase_px"] < 0.08


@pytest.mark.parametrize("width_px", [4.0, 12.0, 30.0])
def test_noisy_truth_is_smoothed_enough(width_px):
    """A penumbra of 64 samples per pixel, and a layer that knows it exactly, moved by half a pixel: most of the
    staircase that the noise would give is gone, and the shift is right."""
    _, across = edge_coordinates(*sample_centres(WIDTH, HEIGHT), 23.0)
    truth = np.random.default_rng(3).binomial(64, np.clip(0.5 - across / width_px, 0.0, 1.0)) / 64.0
    layer = np.clip(0.5 - (across - 0.5) / width_px, 0.0, 1.0)
    everywhere = np.ones(truth.shape, bool)
    found = []
    for values in (truth, contour.smooth_noise(truth, everywhere)):
        pieces = true_border.TrueBorder(contour.trace_contour(values), everywhere)
        found.append(border.measure_border(layer, values >= 0.5, everywhere, pieces).values)
    assert found[1]["staircase_px"] < 0.25 and found[1]["staircase_px"] < 0.6 * found[0]["staircase_px"]
    assert found[1]["border_bias_px"] == pytest.approx(0.5, abs=0.1)


def test_smoothing_leaves_aside_what_is_not_counted():
    values = np.full((9, 11), 0.75)
    counted = np.ones((9, 11), bool)
    values[:, 7:], counted[:, 7:] = 0.0, False
    np.testing.assert_allclose(contour.average_values(values, counted, 5), values)
    assert contour.smooth_noise(np.ones((1, 1)), np.ones((1, 1), bool)).shape == (1, 1)


# ---- what has no partner


def test_true_border_without_partner_is_counted():
    """Beyond the middle the layer knows no shadow at all: half of the border has no partner, the rest is as it was."""
    angle = 3.0
    layer = draw_layer(angle, 0.5)
    layer[:, WIDTH // 2 :] = 1.0
    found = measure_edge(layer, draw_truth(angle, SAMPLES), SAMPLES)
    assert found.values["unpaired_fraction"] == pytest.approx(0.5, abs=0.02)
    assert found.values["border_bias_px"] == pytest.approx(0.5, abs=0.15)
    assert found.lengths_px["compared"] + found.lengths_px["unpaired"] == pytest.approx(WIDTH, rel=0.02)


def test_stray_borders_of_the_layer_are_counted():
    layer = draw_layer(3.0, 0.0)
    layer[180:184, 40:44] = 1.0 - layer[181, 41]  # a speckle far from the border
    found = measure_edge(layer, draw_truth(3.0, SAMPLES), SAMPLES)
    assert found.stray_pixels == 12 + 16  # its rim, from inside and from outside
    assert found.border_pixels > 600
    assert found.values["staircase_px"] < 0.1 and found.values["unpaired_fraction"] == 0


def test_borders_of_other_things_are_left_aside():
    """A border that isn't the shadow's (say, an object's outline before the ground) counts nowhere."""
    truth = draw_truth(3.0, SAMPLES)
    usable = np.ones((HEIGHT, WIDTH), bool)
    usable[:, : WIDTH // 2] = False
    layer = draw_layer(3.0, 1.0)
    layer[:, : WIDTH // 2] = 1.0 - layer[:, : WIDTH // 2]
    found = measure_edge(layer, truth, SAMPLES, usable)
    assert found.lengths_px["left_aside"] == pytest.approx(WIDTH / 2, rel=0.02)
    assert found.values["border_bias_px"] == pytest.approx(1.0, abs=0.15)
    assert found.values["unpaired_fraction"] < 0.02


def test_no_border_has_no_figures():
    truth = np.ones((8 * SAMPLES, 9 * SAMPLES), bool)
    found = measure_edge(np.ones((8, 9), np.float32), truth, SAMPLES)
    assert set(found.values.values()) == {None}
    assert set(found.values) == set(border.BORDER_VALUES)
    one = measure_edge(np.ones((1, 1), np.float32), np.ones((1, 1), bool), 1)
    assert set(one.values.values()) == {None}


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_values_that_are_not_finite_are_wrong(bad):
    layer = draw_layer(8.0, 0.0)
    layer[:, 100:140] = bad
    found = measure_edge(layer, draw_truth(8.0, SAMPLES), SAMPLES)
    assert all(value is None or math.isfinite(value) for value in found.values.values())


def test_texels_without_end_do_not_spoil_the_figures():
    """Where the light runs along the face a texel has no end: no figure becomes infinite."""

    def texels(rows, columns):
        matrices = np.broadcast_to(3.0 * np.eye(2), (len(rows), 2, 2)).copy()
        matrices[columns > 200] = np.inf
        return matrices

    values = measure_edge(draw_layer(8.0, 0.6), draw_truth(8.0, SAMPLES), SAMPLES, texels=texels).values
    assert all(math.isfinite(value) for value in values.values())


# ---- where a border is a shadow's


def test_usable_pixels_lie_within_one_surface():
    """A floor, a wall that rises from it at a crease, and a plate that hangs before both."""
    height, width = 40, 60
    positions, normals = np.zeros((height, width, 3)), np.zeros((height, width, 3))
    rows, columns = np.mgrid[0:height, 0:width].astype(float)
    floor = rows < 20
    positions[..., 0] = 0.1 * columns
    positions[..., 1] = np.where(floor, 0.3 * rows, 0.3 * 19.5)
    positions[..., 2] = np.where(floor, 0.0, 0.1 * (rows - 19.5))
    normals[floor], normals[~floor] = (0, 0, 1), (0, -1, 0)
    plate = (rows > 8) & (rows < 32) & (columns > 20) & (columns < 34)
    positions[plate, 1], positions[plate, 2] = -4.0, 0.1 * rows[plate]
    normals[plate] = (0, -1, 0)
    comparable = np.ones((height, width), bool)
    comparable[5, 50] = False
    usable = true_border.find_usable(comparable, positions, normals, np.full((height, width), 0.1))
    assert usable[17:23, 5:15].all()  # across the crease
    assert not usable[10:30, 20:22].any() and not usable[10:30, 33:35].any()  # at the plate's outline
    assert usable[12:28, 24:31].all()  # within the plate
    assert not usable[4:7, 49:52].any() and usable[4:7, 54].all()
