# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes from frame to frame: edges that move smoothly, crawl and pop, seen by still and by moving cameras."""

import math
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parent))

from analytic_edges import edge_coordinates, sample_centres, sawtooth
from compare import temporal

SIZE = WIDTH, HEIGHT = 160, 120
PIXEL = 0.05


def look_down(x=0.0, y=0.0, *, perspective=False, slope=0.0):
    """A camera that looks down on the plane z = slope * x from above (x, y), and what it shows."""
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, 10.0)
    half_x, half_y = 0.5 * WIDTH * PIXEL, 0.5 * HEIGHT * PIXEL
    scale = 0.1 if perspective else 1.0
    camera = SimpleNamespace(
        perspective=perspective,
        window=(-half_x * scale, half_x * scale, -half_y * scale, half_y * scale),
        world_from_camera=matrix,
    )
    px, py = sample_centres(*SIZE)
    u, v = np.broadcast_arrays((px * PIXEL - half_x) * scale, (py * PIXEL - half_y) * scale)
    if perspective:
        depth = (10.0 - slope * x) / (1.0 + slope * u)
        positions = np.stack([u * depth, v * depth, -depth], axis=2)
    else:
        positions = np.stack([u, v, slope * (u + x) - 10.0], axis=2)
    normal = np.array([-slope, 0.0, 1.0]) / math.hypot(1.0, slope)
    normals = np.broadcast_to(normal, positions.shape)
    comparable = np.ones((HEIGHT, WIDTH), bool)
    return temporal.SeenFrame(positions, normals, comparable, matrix[:3, 3].copy(), camera)


def draw(moved, wave=None):
    """Lit before an edge that has moved; the wave takes the place along it and how far it moved."""
    along, across = edge_coordinates(*sample_centres(*SIZE), 13.0, SIZE)
    return (across < moved + (wave(along, moved) if wave else 0.0)).astype(np.float32)


def measure_moves(wave, step=0.35, frames=12, shift=0.0):
    seen = look_down()
    sums = temporal.TemporalSums()
    places = temporal.find_same_places(seen, seen)
    for frame in range(1, frames):
        moves = [(frame - 1) * step, frame * step]
        layers = tuple(draw(moved + shift, wave) for moved in moves)
        sums.add(places, layers, tuple(draw(moved) > 0.5 for moved in moves))
    assert sums.pixel_count == (frames - 1) * WIDTH * HEIGHT
    return sums.compute()


def test_edge_that_moves_as_the_truth_does_not_flicker():
    values = measure_moves(None)
    assert values["temporal_rms"] == 0 and values["temporal_blocks_rms"] == 0
    assert values["temporal_change_ratio"] == 1.0
    # 0.35 pixels a step over the edge's length of pixels change.
    share = 0.35 * WIDTH / math.cos(math.radians(13.0)) / (WIDTH * HEIGHT)
    assert values["temporal_truth_rms"] == pytest.approx(math.sqrt(share), rel=0.1)
    assert values["temporal_layer_rms"] == values["temporal_truth_rms"]


def test_crawling_sawtooth_flickers():
    """Teeth that run along the edge by half their length for each step of it, against teeth that stay."""
    still = measure_moves(lambda along, moved: sawtooth(along, 16.0, 4.0))
    crawling = measure_moves(lambda along, moved: sawtooth(along - 23.0 * moved, 16.0, 4.0))
    smooth = measure_moves(None, shift=1.5)
    for name in ("temporal_rms", "temporal_blocks_rms"):
        assert crawling[name] > 1.5 * still[name], name
        assert crawling[name] > 1.5 * smooth[name], name
    assert crawling["temporal_change_ratio"] > 2.0
    assert still["temporal_change_ratio"] == pytest.approx(1.0, abs=0.05)
    assert smooth["temporal_change_ratio"] == pytest.approx(1.0, abs=0.05)


def test_shift_that_stays_is_no_flicker_over_blocks():
    """An edge beside the true one changes other pixels, but as many of them: blocks hold both, but for a few."""
    shifted = measure_moves(None, shift=1.5)
    popping = measure_moves(lambda along, moved: np.round(moved / 1.4) * 1.4 - moved)
    assert shifted["temporal_rms"] > 0
    assert shifted["temporal_blocks_rms"] < 0.5 * popping["temporal_blocks_rms"]


def test_amplitude_by_hand():
    """Every pixel of the layer jumps by 0.25 while the truth stands: all figures follow."""
    seen = look_down()
    places = temporal.find_same_places(seen, seen)
    sums = temporal.TemporalSums()
    one, other = np.full((HEIGHT, WIDTH), 0.5), np.full((HEIGHT, WIDTH), 0.75)
    truth = np.ones((HEIGHT, WIDTH), bool)
    sums.add(places, (one, other), (truth, truth))
    sums.add(places, (other, one), (truth, truth))
    values = sums.compute()
    assert values["temporal_rms"] == pytest.approx(0.25) and values["temporal_blocks_rms"] == pytest.approx(0.25)
    assert values["temporal_layer_rms"] == pytest.approx(0.25) and values["temporal_truth_rms"] == 0
    assert values["temporal_change_ratio"] is None
    assert set(values) == {info.id for info in temporal.TEMPORAL_MEASURES}


@pytest.mark.parametrize("perspective", [False, True])
@pytest.mark.parametrize("slope", [0.0, 0.4])
def test_moving_camera_finds_the_same_places(perspective, slope):
    before = look_down(perspective=perspective, slope=slope)
    now = look_down(0.37 * PIXEL, -1.2 * PIXEL, perspective=perspective, slope=slope)
    places = temporal.find_same_places(before, now)
    assert len(places.rows) > 0.95 * WIDTH * HEIGHT
    # A picture that is linear in the world is looked up as it is at the place.
    world_before = before.positions_rel + before.origin_ws
    world_now = (now.positions_rel + now.origin_ws)[places.rows, places.columns]
    for axis in (0, 1):
        tolerance = 1e-9 if not perspective or slope == 0 else 0.02 * PIXEL
        np.testing.assert_allclose(places.look_up(world_before[..., axis]), world_now[:, axis], atol=tolerance)
    # So a shadow that lies still on the surface doesn't change, but for what lies between the pixels.
    sums = temporal.TemporalSums()
    values = [1.0 / (1.0 + np.exp(4.0 * world[..., 0])) for world in (world_before, now.positions_rel + now.origin_ws)]
    sums.add(places, (values[0], values[1]), (values[0], values[1]))
    found = sums.compute()
    assert found["temporal_rms"] < 1e-12 and found["temporal_layer_rms"] < 2e-3


def test_other_surfaces_are_not_the_same_place():
    before, now = look_down(), look_down(0.5 * PIXEL)
    positions = np.array(now.positions_rel)
    positions[:40, :, 2] += 0.2  # something has come up
    comparable = now.comparable.copy()
    comparable[100:, :] = False
    now = temporal.SeenFrame(positions, now.normals, comparable, now.origin_ws, now.camera)
    places = temporal.find_same_places(before, now)
    assert places.rows.min() == 40 and places.rows.max() == 99
    nothing = temporal.SeenFrame(positions, now.normals, np.zeros_like(comparable), now.origin_ws, now.camera)
    none = temporal.find_same_places(before, nothing)
    sums = temporal.TemporalSums()
    picture = np.ones((HEIGHT, WIDTH))
    sums.add(none, (picture, picture), (picture, picture))
    assert set(sums.compute().values()) == {None}


def test_one_pixel_and_bad_values():
    frame = look_down()
    small = temporal.SeenFrame(
        frame.positions_rel[:1, :1] * 0 + [0, 0, -10.0], frame.normals[:1, :1], np.ones((1, 1), bool),
        frame.origin_ws, frame.camera,
    )  # fmt: skip
    places = temporal.find_same_places(small, small)
    sums = temporal.TemporalSums()
    sums.add(places, (np.full((1, 1), np.nan), np.ones((1, 1))), (np.zeros((1, 1)), np.ones((1, 1))))
    assert all(value is None or math.isfinite(value) for value in sums.compute().values())
