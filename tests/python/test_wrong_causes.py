# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sorting wrong pixels by cause: scenes in which each cause is known, and rays against closed forms."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

from compare import plain_rays, scene_triangles, wrong_causes

ALL_GROUPS = 0xFFFFFFFFFFFFFFFF
WIDTH, HEIGHT = 64, 48
PIXEL = 0.01
CAMERA_HEIGHT = 9.0


def make_rectangle(x0, x1, y0, y1, z):
    return [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)], [(0, 1, 2), (0, 2, 3)]


def make_snapshot(*meshes):
    count = len(meshes)
    return SimpleNamespace(
        meshes=[
            SimpleNamespace(positions=np.asarray(p, np.float32), triangles=np.asarray(t, np.uint32)) for p, t in meshes
        ],
        instance_mesh=np.arange(count, dtype=np.uint32),
        instance_matrix=np.stack([np.eye(4)] * count),
        instance_flags=np.full(count, 3, np.uint32),
        instance_blocker_group=np.zeros(count, np.uint8),
    )


def look_down(height):
    matrix = np.eye(4)
    matrix[2, 3] = height
    return matrix


def make_camera(perspective):
    """Straight down; a pixel is PIXEL wide on the ground and the picture's middle lies at its origin."""
    half = np.array([WIDTH, HEIGHT]) * PIXEL / 2 / (CAMERA_HEIGHT if perspective else 1.0)
    return SimpleNamespace(
        perspective=perspective,
        window=(-half[0], half[0], -half[1], half[1]),
        clip_start=0.1,
        clip_end=100.0,
        world_from_camera=look_down(CAMERA_HEIGHT),
    )


def make_light(kind, height=8.0, tilt=0.0):
    """Above the origin, or from over positive x by `tilt` (a tangent)."""
    matrix = look_down(height)
    z = np.array([tilt, 0.0, 1.0]) / np.hypot(tilt, 1.0)
    matrix[:3, :3] = np.stack([np.cross([0, 1, 0], z), [0, 1, 0], z], axis=1)
    matrix[:3, 3] = height * np.array([tilt, 0.0, 1.0])
    return SimpleNamespace(kind=kind, world_from_light=matrix, casts_shadow=True, blocker_set=ALL_GROUPS)


GROUND = make_rectangle(-3, 3, -3.1, 2.9, 0.0)
# Casts, and isn't seen by the camera.
PLATE = make_rectangle(0.005, 2.0, -2.0, 2.0, 2.0)


class Case:
    """Pixels of the ground beneath casters, the last of them moved by `move`. The camera sees the first `seen`."""

    def __init__(self, *meshes, light, perspective=True, seen=1, move=(0.0, 0.0, 0.0)):
        self.snapshot = make_snapshot(*meshes)
        self.snapshot.instance_matrix[-1][:3, 3] = move
        self.snapshot.instance_flags[seen:] = scene_triangles.INSTANCE_SHADOW
        self.triangles = scene_triangles.gather_triangles(self.snapshot)
        self.camera, self.light = make_camera(perspective), light
        self.origin = self.camera.world_from_camera[:3, 3]
        visible = np.flatnonzero((self.snapshot.instance_flags & 1)[self.triangles.instance])
        self.sorter = wrong_causes.CauseSorter(
            self.triangles,
            seen=plain_rays.TriangleRays(self.triangles, visible, self.origin),
            casters=scene_triangles.find_casters(self.triangles, self.snapshot, light),
            light=light,
            origin_ws=self.origin,
            depths=(0.1, 100.0),
        )

    @staticmethod
    def get_centre(row, column):
        return (column + 0.5 - WIDTH / 2) * PIXEL, (row + 0.5 - HEIGHT / 2) * PIXEL

    def sort(self, column, *, layer, truth, beside=(0.0, 0.0), height=0.0, taken=0, row=20):
        """The cause at one pixel. `beside`: how far from the centre Cycles' point lies, in scene units."""
        x, y = self.get_centre(row, column)
        part = 1.0 - height / CAMERA_HEIGHT if self.camera.perspective else 1.0
        point = np.array([[x * part + beside[0], y * part + beside[1], height]]) - self.origin
        pixels = wrong_causes.make_wrong_pixels(
            np.array([row]), np.array([column]),
            layer_triangles=np.array([taken]), layer_lit=np.array([layer]), truth_lit=np.array([truth]),
            truth_points=point, camera=self.camera, width=WIDTH, height=HEIGHT,
        )  # fmt: skip
        return self.sorter.sort(pixels)[0]


MIDDLE = WIDTH // 2  # its pixel's centre lies at x = half a pixel, where the plate's shadow begins for lights above


@pytest.mark.parametrize("perspective", [True, False])
@pytest.mark.parametrize("kind", ["SUN", "POINT"])
def test_far_from_every_border_either_is_simply_wrong(kind, perspective):
    case = Case(GROUND, PLATE, light=make_light(kind), perspective=perspective)
    for column, lit in ((MIDDLE - 9, True), (MIDDLE + 9, False)):
        assert case.sort(column, layer=not lit, truth=lit) == "technique"
        assert case.sort(column, layer=lit, truth=not lit) == "unexplained"


@pytest.mark.parametrize("perspective", [True, False])
@pytest.mark.parametrize("kind", ["SUN", "POINT"])
def test_cycles_may_look_across_the_border(kind, perspective):
    """The border lies 1e-4 beyond the centre, Cycles' point 2e-4; half of the way doesn't reach it."""
    edge = Case.get_centre(0, MIDDLE)[0] + 1e-4
    at_plate = edge * (1.0 if kind == "SUN" else 0.75)  # of the way from the lamp at 8 to the ground, 6 are done at 2
    plate = make_rectangle(at_plate, 2.0, -2.0, 2.0, 2.0)
    case = Case(GROUND, plate, light=make_light(kind), perspective=perspective)
    assert case.sort(MIDDLE, layer=True, truth=False, beside=(2e-4, 0.0)) == "place"
    assert case.sort(MIDDLE, layer=True, truth=False, beside=(5e-5, 0.0)) == "unexplained"
    assert case.sort(MIDDLE, layer=False, truth=True, beside=(2e-4, 0.0)) == "technique"


def test_offsets_from_the_centre_are_told_in_pixels():
    for perspective in (True, False):
        x, y = Case.get_centre(20, MIDDLE)
        points = np.array([[x + 0.3 * PIXEL, y - 0.4 * PIXEL, -CAMERA_HEIGHT]])
        pixels = wrong_causes.make_wrong_pixels(
            np.array([20]), np.array([MIDDLE]),
            layer_triangles=np.array([0]), layer_lit=np.array([True]), truth_lit=np.array([False]),
            truth_points=points, camera=make_camera(perspective), width=WIDTH, height=HEIGHT,
        )  # fmt: skip
        assert pixels.truth_offsets_px == pytest.approx([0.5])


def test_a_border_within_roundings_of_the_ray_is_rounding():
    """A border as near to the centre as a float32 step of the largest coordinate, 9; not one 50 times as far."""
    step = 9.0 * wrong_causes.FLOAT_EPS
    for steps, cause in ((1, "rounding"), (-1, "rounding"), (50, "unexplained"), (-50, "unexplained")):
        # The plate is moved by its matrix: float32 corners have no such steps.
        edge = Case.get_centre(0, MIDDLE)[0] + steps * step
        case = Case(GROUND, make_rectangle(0, 2, -2, 2, 2.0), light=make_light("SUN"), move=(edge, 0.0, 0.0))
        lit = steps > 0
        assert case.sort(MIDDLE, layer=lit, truth=not lit) == cause, steps


def test_a_contact_nearer_than_cycles_start_is_the_offset():
    """A plate a hair above the ground, in a light far from steep: Cycles' ray, moved up, starts above it."""
    for gap, cause in ((4e-6, "offset"), (4e-4, "unexplained")):
        case = Case(GROUND, make_rectangle(0.005, 2, -2, 2, gap), light=make_light("SUN", tilt=0.5))
        assert case.sort(MIDDLE + 9, layer=False, truth=True) == cause, gap


def test_what_lies_in_the_receivers_plane_has_no_answer():
    case = Case(GROUND, make_rectangle(0.005, 2, -2, 2, 0.0), light=make_light("SUN", tilt=0.5))
    for layer in (True, False):
        assert case.sort(MIDDLE + 9, layer=layer, truth=not layer) == "ambiguous"


def test_another_face_under_cycles_ray_is_an_edge():
    """A shelf begins just beyond the pixel's centre. What the light lets pass on the ground, it keeps off the shelf."""
    begin = Case.get_centre(0, MIDDLE)[0] + 1e-6
    ground = make_rectangle(-3, 3, -3.1, 2.9, 0.0)
    shelf = make_rectangle(begin, begin + 0.3, -3.1, 2.9, 0.5)
    bar = make_rectangle(begin + 0.4, begin + 0.6, -2, 2, 1.0)  # the light comes from over positive x, at 45 degrees
    case = Case(ground, shelf, bar, light=make_light("SUN", tilt=1.0), perspective=False, seen=2)
    assert case.sort(MIDDLE, layer=True, truth=False, beside=(1e-5, 0.0), height=0.5) == "edge"
    assert case.sort(MIDDLE, layer=False, truth=True, beside=(1e-5, 0.0), height=0.5) == "technique"


def test_a_layer_that_took_another_triangle_is_told_from_a_wrong_shadow():
    """A tile of the ground stands a little higher; taken for the ground beneath, its pixels are in its shadow."""
    tile = make_rectangle(-0.2, 0.2, -0.2, 0.2, 0.001)
    case = Case(GROUND, tile, light=make_light("SUN", tilt=0.5), seen=2)
    assert case.sort(MIDDLE, layer=False, truth=True, height=0.001, taken=0) == "raster"
    assert case.sort(MIDDLE, layer=False, truth=True, height=0.001, taken=2) == "technique"


# ---- rays


def test_rays_meet_what_brute_force_meets():
    random = np.random.default_rng(4)
    corners = random.normal(size=(400, 3, 3)) * 0.3 + random.normal(size=(400, 1, 3))
    triangles = SimpleNamespace(corners_ws=corners + 7.0)
    rays = plain_rays.TriangleRays(triangles, np.arange(400), np.full(3, 7.0))
    for _ in range(50):
        start, direction = random.normal(size=3), random.normal(size=3)
        expected = {}
        for index, (a, b, c) in enumerate(corners):
            # start + s d = a + u (b - a) + v (c - a)
            s, u, v = np.linalg.solve(np.stack([-direction, b - a, c - a], axis=1), start - a)
            if u >= 0 and v >= 0 and u + v <= 1 and 0 < s < 1.5:
                expected[index] = s
        near = rays.find_near(start, direction, 1.5, 0.0)
        found = plain_rays.meet(near.corners, start, direction)
        there = (found > 0) & (found < 1.5)
        assert set(near.index[there]) == set(expected)
        assert found[there] == pytest.approx([expected[index] for index in near.index[there]])
        first = plain_rays.find_first(near, start, direction, 0.0, 1.5)
        assert (first < 0) == (not expected)
        if expected:
            assert near.index[first] == min(expected, key=expected.get)


def test_flat_neighbours_are_those_at_an_edge_in_the_plane():
    own = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    others = np.array([
        own[[1, 2, 0]],
        [[1, 0, 0], [0, 1, 0], [1, 1, 0]],
        [[1, 0, 0], [0, 1, 0], [1, 1, 1e-7]],
        [[1, 0, 0], [0, 1, 0], [1, 1, 1e-3]],
        [[1, 0, 0], [2, 0, 0], [1, 1, 0]],
    ])  # fmt: skip
    assert plain_rays.find_flat_neighbours(others, own).tolist() == [True, True, True, False, False]


def test_the_moved_start_is_256_steps_of_float32_or_a_fixed_length():
    moved = wrong_causes.offset_start(np.array([2.0, -5.0, 0.01]), np.array([1.0, -1.0, 1.0]))
    assert moved[0] == 2.0 + 256 * np.spacing(np.float32(2.0))
    assert moved[1] == -5.0 - 256 * np.spacing(np.float32(5.0))
    assert moved[2] == pytest.approx(0.01 + 1 / 65536, rel=1e-6)
