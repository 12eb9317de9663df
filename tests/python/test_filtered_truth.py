# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The filtered truth against closed forms and brute force."""

import math
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

from compare import scene_triangles
from compare.filtered_truth import compute_filtered_visibility
from compare.light_bins import View, make_views
from compare.light_squares import Footprint, Receivers
from compare.sample_points import PixelSamples

ALL_GROUPS = 0xFFFFFFFFFFFFFFFF
LIGHT = SimpleNamespace(casts_shadow=True, blocker_set=ALL_GROUPS)


def make_snapshot(*meshes, matrices=None):
    """Each mesh (positions, triangles) once."""
    count = len(meshes)
    return SimpleNamespace(
        meshes=[
            SimpleNamespace(positions=np.asarray(p, np.float32), triangles=np.asarray(t, np.uint32)) for p, t in meshes
        ],
        instance_mesh=np.arange(count, dtype=np.uint32),
        instance_matrix=np.stack(matrices or [np.eye(4)] * count),
        instance_flags=np.full(count, 3, np.uint32),
        instance_blocker_group=np.zeros(count, np.uint8),
    )


def make_rectangle(x0, x1, y0, y1, z):
    return [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)], [(0, 1, 2), (0, 2, 3)]


def make_view(kind, height=8.0, texel=0.05, place=(0.0, 0.0)):
    """Straight down from `height`; a texel is that large on z = 0."""
    matrix = np.eye(4)
    matrix[:3, 3] = -place[0], -place[1], -height
    size = texel / (height if kind == "SPOT" else 1.0)
    return View(kind == "SPOT", (size, size), matrix)


def cast(snapshot, views, points, instances, numbers, *, texels=0.0, world=0.0, samples=64, light=LIGHT):
    triangles = scene_triangles.gather_triangles(snapshot)
    casters = scene_triangles.find_casters(triangles, snapshot, light)
    points = np.asarray(points, np.float64)
    of = triangles.find_triangles(np.broadcast_to(instances, len(points)), np.broadcast_to(numbers, len(points)))
    receivers = Receivers(points, of, np.arange(len(points)))
    return compute_filtered_visibility(
        triangles, casters, views=views, receivers=receivers, footprint=Footprint(texels, world), sample_count=samples
    )


GROUND = make_rectangle(-20, 20, -20, 20, 0.0)


def put_on_ground(x, y):
    """Points and the numbers of the ground's triangles that they lie on."""
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    return np.stack([x, y, np.zeros(x.shape)], axis=1), (y > x).astype(int)


@pytest.mark.parametrize("kind", ["SUN", "SPOT"])
@pytest.mark.parametrize("unit", ["texels", "world"])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_straight_edge_is_a_ramp_of_the_squares_width(kind, unit, angle):
    """A half plane's edge over flat ground: the part of the square beyond the edge, in closed form."""
    side = 7 * 0.05
    # The edge at height 2 casts to x = 8 / 6 x of it from the spot, whose square on the ground is as in the map.
    scale = 8 / 6 if kind == "SPOT" else 1.0
    edge = 0.3
    turn = np.eye(4)
    turn[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    plate = make_rectangle(-15, edge / scale, -15, 15, 2.0)
    snapshot = make_snapshot(GROUND, plate, matrices=[np.eye(4), turn])
    offset = np.linspace(-0.4, 0.4, 33)
    along = np.linspace(-1, 1, 33)
    beyond = edge + offset
    points, numbers = put_on_ground(
        beyond * math.cos(angle) - along * math.sin(angle), beyond * math.sin(angle) + along * math.cos(angle)
    )
    amount = {"texels": 7.0} if unit == "texels" else {"world": side}
    found = cast(snapshot, [make_view(kind)], points, 0, numbers, samples=1024, **amount)
    # In the plane of the ground the square's axes are those of the map.
    samples = np.linspace(-0.5, 0.5, 401)
    a, b = (
        axis.ravel() for axis in np.meshgrid(0.5 * (samples[1:] + samples[:-1]), 0.5 * (samples[1:] + samples[:-1]))
    )
    expected = [np.mean(o + side * (a * math.cos(angle) + b * math.sin(angle)) >= 0) for o in offset]
    np.testing.assert_allclose(found.visibility, expected, atol=0.006)
    if angle == 0.0:
        np.testing.assert_allclose(expected, np.clip(0.5 + offset / side, 0, 1), atol=0.002)
    assert found.visibility.min() == 0 and found.visibility.max() == 1
    error = np.sqrt(np.mean(np.square(found.visibility - expected)))
    reported = np.sqrt(np.mean(np.square(found.error)))
    assert 0.5 * reported < error < 2 * reported < 0.005
    assert 10 < found.sampled_count < 33


def make_soup(generator, count, size):
    """Triangles here and there between ground and light, each by itself."""
    middles = np.column_stack([generator.uniform(-3, 3, (count, 2)), generator.uniform(0.2, 6, count)])
    corners = middles[:, None] + generator.normal(0, size, (count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def find_blocked_brute(view, corners_ws, skipped, origin_ls, *, normal_ls, rays):
    """Whether each ray to the plane meets a triangle before it: every triangle, by the textbook."""
    corners = view.transform(corners_ws)
    direction = rays if view.perspective else np.tile([0.0, 0.0, -1.0], (len(rays), 1))
    start = np.zeros(3) if view.perspective else np.column_stack([rays[:, :2], np.full(len(rays), 100.0)])
    to_plane = (normal_ls @ origin_ls - (start @ normal_ls)) / (direction @ normal_ls)
    to_plane = np.where(to_plane > 0, to_plane, np.inf)
    blocked = np.zeros(len(rays), bool)
    for number, (a, b, c) in enumerate(corners):
        if number == skipped:
            continue
        matrix = np.stack([np.broadcast_to(b - a, rays.shape), np.broadcast_to(c - a, rays.shape), -direction], axis=2)
        u, v, t = np.linalg.solve(matrix, np.broadcast_to(start - a, rays.shape)[..., None])[..., 0].T
        blocked |= (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (t < to_plane - 1e-5)
    return blocked


@pytest.mark.parametrize("kind", ["SUN", "SPOT"])
@pytest.mark.parametrize(
    ("texels", "count", "size"), [(5.0, 60, 0.5), (40.0, 60, 0.5), (3.0, 200, 0.15), (0.0, 60, 0.5)]
)
def test_triangles_in_a_heap_against_brute_force(kind, texels, count, size):
    generator = np.random.default_rng(count + int(texels))
    soup = make_soup(generator, count, size)
    receiver = np.array([[-9, -9, 0.1], [9, -9, -0.4], [0, 12, 0.6]], np.float32)
    snapshot = make_snapshot((receiver, [(0, 1, 2)]), soup)
    weights = generator.dirichlet((4, 4, 4), 25)
    points = weights @ receiver.astype(float)
    view = make_view(kind, height=7.0, place=(0.4, -0.3))
    found = cast(snapshot, [view], points, 0, 0, texels=texels, samples=64)
    triangles = scene_triangles.gather_triangles(snapshot)
    plane_ls = view.transform(receiver.astype(float))
    normal_ls = np.cross(plane_ls[1] - plane_ls[0], plane_ls[2] - plane_ls[0])
    a, b = PixelSamples(np.arange(len(points)), 64).make(np.arange(len(points)))
    for index, point_ls in enumerate(view.transform(points)):
        place = point_ls[:2] / (-point_ls[2] if view.perspective else 1)
        rays = np.ones((64, 3)) * (-1 if view.perspective else 1)
        rays[:, 0] = place[0] + texels * view.texel_size[0] * a[index]
        rays[:, 1] = place[1] + texels * view.texel_size[1] * b[index]
        blocked = find_blocked_brute(view, triangles.corners_ws, 0, point_ls, normal_ls=normal_ls, rays=rays)
        assert found.visibility[index] == pytest.approx(1 - blocked.mean(), abs=1e-6), index
    assert 0 < found.visibility.mean() < 1


def make_surface(function, side=24, extent=2.0):
    """A height field as one connected mesh."""
    axis = np.linspace(-extent, extent, side)
    x, y = (values.ravel() for values in np.meshgrid(axis, axis))
    quads = [(r * side + c, r * side + c + 1, (r + 1) * side + c + 1, (r + 1) * side + c)
             for r in range(side - 1) for c in range(side - 1)]  # fmt: skip
    triangles = [triangle for q in quads for triangle in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]
    return np.column_stack([x, y, function(x, y)]), triangles


def put_on_mesh(mesh, generator, count=80, within=1.4):
    positions, triangles = np.asarray(mesh[0], np.float32).astype(float), np.asarray(mesh[1])
    corners = positions[triangles]
    inside = np.flatnonzero(np.abs(corners[..., :2]).max(axis=(1, 2)) < within)
    numbers = generator.choice(inside, count)
    return np.einsum("ik,ikj->ij", generator.dirichlet((1, 1, 1), count), corners[numbers]), numbers


@pytest.mark.parametrize("kind", ["SUN", "SPOT"])
@pytest.mark.parametrize("curvature", [0.15, -0.15])
def test_a_surface_that_the_light_sees_does_not_shadow_itself(kind, curvature):
    """A bowl and a hill, all lit; in the bowl the plane of each receiver lies below the rest of it."""
    mesh = make_surface(lambda x, y: curvature * (x * x + y * y))
    points, numbers = put_on_mesh(mesh, np.random.default_rng(5))
    found = cast(make_snapshot(mesh), [make_view(kind)], points, 0, numbers, texels=12)
    assert (found.visibility == 1).all()


def test_a_bowl_with_an_outer_side_is_lit_inside():
    """The outer side lies between the bowl's inside and the plane of a receiver."""
    inner = make_surface(lambda x, y: 0.4 * (x * x + y * y))
    count = len(inner[0])
    outer_positions = np.array(inner[0]) - (0, 0, 0.02)
    positions = np.concatenate([inner[0], outer_positions])
    triangles = [*inner[1], *(tuple(count + corner for corner in reversed(t)) for t in inner[1])]
    points, numbers = put_on_mesh(inner, np.random.default_rng(6))
    found = cast(make_snapshot((positions, triangles)), [make_view("SUN")], points, 0, numbers, texels=20)
    assert (found.visibility == 1).all()


def test_a_roof_over_a_bowl_shadows_it():
    bowl = make_surface(lambda x, y: 0.15 * (x * x + y * y))
    points, numbers = put_on_mesh(bowl, np.random.default_rng(7))
    snapshot = make_snapshot(bowl, make_rectangle(-20, 0, -20, 20, 3.0))
    found = cast(snapshot, [make_view("SUN")], points, 0, numbers, texels=4, samples=256)
    np.testing.assert_allclose(found.visibility, np.clip(0.5 + points[:, 0] / 0.2, 0, 1), atol=0.02)


def test_a_fold_of_the_same_mesh_casts():
    """An upright wall that hangs over the ground it is connected with: the overhang shows the light its back's side."""
    # Ground from x = -4 to 4, then up, then back over the ground at z = 1 to x = 2.
    profile = [(-4, 0), (4, 0), (4, 1), (2, 1)]
    positions = [(x, y, z) for x, z in profile for y in (-3, 3)]
    triangles = []
    for k in range(3):
        triangles += [(2 * k, 2 * k + 2, 2 * k + 1), (2 * k + 1, 2 * k + 2, 2 * k + 3)]
    x = np.linspace(1, 3, 21)
    points = np.column_stack([x, np.full(21, 0.2), np.zeros(21)])
    numbers = [0 if -3 + 6 * (4 - value) / 8 > 0.2 else 1 for value in x]
    found = cast(make_snapshot((positions, triangles)), [make_view("SUN")], points, 0, numbers, texels=8, samples=256)
    np.testing.assert_allclose(found.visibility, np.clip(0.5 - (x - 2) / 0.4, 0, 1), atol=0.01)


def make_box(size, base):
    half = size / 2
    corners = [(x * half, y * half, base + z * size) for x in (-1, 1) for y in (-1, 1) for z in (0, 1)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]


def aim(direction, texel):
    """A sun's view along a direction."""
    z = -np.asarray(direction, float) / np.linalg.norm(direction)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([x, np.cross(z, x), z])
    return View(False, (texel, texel), matrix)


@pytest.mark.parametrize("side", [2, 17])
@pytest.mark.parametrize("sunk", [0.0, 0.02])
def test_the_side_of_a_box_on_the_ground_is_lit(side, sunk):
    """Below its foot the side's plane goes on in the ground, where the light can't reach. The ground is another object,
    coarse or fine; the box stands on it, or is sunk a little. What lies before the box shadows it all the same."""
    ground = make_surface(lambda x, y: 0.0 * x, side=side, extent=20.0 if side == 2 else 5.0)
    box = make_box(2.0, -sunk)
    view = aim((-1, 0.2, -1.5), 0.05)  # from where x is large: the side x = 1 faces it
    z = np.linspace(0.02, 1.5, 40)
    points = np.column_stack([np.full(40, 1.0), np.full(40, 0.3), z])
    # The side's quad (4, 6, 7, 5) has triangles 2 and 3, parted by the diagonal from (y, z) = (-1, foot) to (1, top).
    numbers = np.where(z + sunk < 0.3 + 1, 2, 3)
    found = cast(make_snapshot(ground, box), [view], points, 1, numbers, texels=10)
    assert (found.visibility >= 1 - 4 * sunk).all()
    shade = make_rectangle(1.2, 6, -5, 5, 1.4)
    shadowed = cast(make_snapshot(ground, box, shade), [view], points, 1, numbers, texels=2)
    assert (shadowed.visibility[(z > 0.1) & (z < 1.0)] == 0).all()
    # On the ground beside the box, on the light's side and in the shadow.
    beside = np.column_stack([[1.05, 1.5, -1.05, -1.3], np.full(4, 0.1), np.zeros(4)])
    cells = side - 1
    column, line = ((beside[:, axis] + (20 if side == 2 else 5)) / (40 if side == 2 else 10) * cells for axis in (0, 1))
    quad = line.astype(int) * cells + column.astype(int)
    numbers = 2 * quad + (line % 1 > column % 1)
    found = cast(make_snapshot(ground, box), [view], beside, 0, numbers, texels=2)
    assert found.visibility[1] == 1 and (found.visibility[2:] == 0).all()


def test_a_card_that_stands_on_the_ground_shadows_it():
    """It meets the ground's plane, but the ground goes on behind it."""
    card = [(0, -9, 0), (0, 9, 0), (0, 9, 3), (0, -9, 3)], [(0, 1, 2), (0, 2, 3)]
    view = aim((-1, 0, -1), 0.1)
    x = np.linspace(-1, 1, 41)
    points, numbers = put_on_ground(x, 0.2)
    for flags in (3, 1):  # also where the ground is no caster
        snapshot = make_snapshot(GROUND, card)
        snapshot.instance_flags[0] = flags
        found = cast(snapshot, [view], points, 0, numbers, texels=4, samples=256)
        # A texel of the map is sqrt(2) as long on the ground.
        np.testing.assert_allclose(found.visibility, np.clip(0.5 + x / (0.4 * math.sqrt(2)), 0, 1), atol=0.02)


def test_triangles_behind_and_across_the_light_do_no_harm():
    """A large floor that passes below the light and behind it; a plate beyond the floor; one behind the light."""
    view = make_view("SPOT")
    tilted = [(-50, 0, 30), (50, 0, 30), (0, 0, -40)]
    snapshot = make_snapshot(
        GROUND, make_rectangle(-9, 9, -9, 9, 9.0), make_rectangle(-9, 9, -9, 9, -1.0), (tilted, [(0, 1, 2)])
    )
    points, numbers = put_on_ground(np.linspace(-3, 3, 31), np.linspace(0.5, 3, 31))
    found = cast(snapshot, [view], points, 0, numbers, texels=5)
    assert (found.visibility == 1).all()
    points[:, 1] *= -1
    numbers = (points[:, 1] > points[:, 0]).astype(int)
    assert (cast(snapshot, [view], points, 0, numbers, texels=5).visibility == 1).all()
    points, numbers = put_on_ground(np.linspace(-3, 3, 31), 0.0)  # right below the sheet: half of the square each
    found = cast(snapshot, [view], points, 0, numbers, texels=5)
    assert (found.visibility > 0.9).all()  # an upright sheet through the light hides nothing but itself


def test_views_of_a_cube_share_the_receivers():
    """Six faces round a light in a room; a plate before each wall casts a shadow of the same size."""
    axes = [np.eye(3)[[1, 2, 0]], np.eye(3)[[2, 0, 1]], np.eye(3)]
    views = []
    for axis in axes:
        for sign in (1, -1):
            matrix = np.eye(4)
            matrix[:3, :3] = np.stack([axis[0], -sign * axis[1], -sign * axis[2]])
            assert np.linalg.det(matrix[:3, :3]) == pytest.approx(1)
            views.append(View(True, (0.02, 0.02), matrix))
    walls = [
        (
            np.array(make_rectangle(-4, 4, -4, 4, 4.0)[0]) @ view.view_from_world[:3, :3] * (1, 1, 1),
            [(0, 1, 2), (0, 2, 3)],
        )
        for view in views
    ]
    plates = [
        (np.array(make_rectangle(-1, 1, -1, 1, 2.0)[0]) @ view.view_from_world[:3, :3], [(0, 1, 2), (0, 2, 3)])
        for view in views
    ]
    generator = np.random.default_rng(3)
    place = generator.uniform(-3.5, 3.5, (50, 2))
    for number, view in enumerate(views):
        # The walls lie at view z = +4: the view of the opposite face looks at them.
        points = np.column_stack([place, np.full(50, 4.0)]) @ view.view_from_world[:3, :3]
        triangle = (place[:, 1] > place[:, 0]).astype(int)
        found = cast(make_snapshot(*walls, *plates), views, points, number, triangle, texels=5, samples=256)
        nearest = np.abs(place).max(axis=1)
        np.testing.assert_array_equal(found.visibility[nearest < 1.79], 0)
        np.testing.assert_array_equal(found.visibility[nearest > 2.21], 1)


@pytest.mark.parametrize("kind", ["SUN", "POINT"])
def test_views_of_a_light_without_maps(kind):
    """Turned lights: each point is seen by a view, and the square on the ground is as large as in a map's view."""
    matrix = np.eye(4)
    matrix[:3, :3] = [[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]]
    matrix[:3, 3] = 0.2, 0.3, 8.0
    views = make_views(kind, matrix)
    assert len(views) == (1 if kind == "SUN" else 6)
    points, numbers = put_on_ground(np.linspace(-6, 6, 60), np.linspace(-6, 5, 60))
    snapshot = make_snapshot(GROUND, make_soup(np.random.default_rng(12), 60, 0.5))
    mine = cast(snapshot, views, points, 0, numbers, world=0.3, samples=256).visibility
    own = make_view("SPOT" if kind == "POINT" else "SUN", place=(0.2, 0.3))
    np.testing.assert_allclose(
        mine, cast(snapshot, [own], points, 0, numbers, world=0.3, samples=256).visibility, atol=0.1
    )
    assert 0.2 < mine.mean() < 1


def test_no_square_is_the_point_itself():
    soup = make_soup(np.random.default_rng(9), 80, 0.5)
    generator = np.random.default_rng(10)
    points, numbers = put_on_ground(*generator.uniform(-3, 3, (2, 300)))
    snapshot = make_snapshot(GROUND, soup)
    view = make_view("SPOT")
    hard = cast(snapshot, [view], points, 0, numbers)
    assert set(np.unique(hard.visibility)) == {0, 1} and hard.error.max() == 0
    small = cast(snapshot, [view], points, 0, numbers, texels=1e-9)
    np.testing.assert_array_equal(hard.visibility, small.visibility)


def test_nothing_to_do():
    found = cast(make_snapshot(GROUND), [make_view("SUN")], np.zeros((0, 3)), 0, np.zeros(0, int), texels=3)
    assert found.visibility.shape == found.error.shape == (0,) and found.sampled_count == 0
    points, numbers = put_on_ground([0.0], [0.1])
    assert cast(make_snapshot(GROUND), [], points, 0, numbers, texels=3).visibility == 1


def test_who_does_not_cast():
    points, numbers = put_on_ground([0.0], [0.1])
    snapshot = make_snapshot(GROUND, make_rectangle(-1, 1, -1, 1, 1.0))
    view = make_view("SUN")
    assert cast(snapshot, [view], points, 0, numbers).visibility == 0
    for light in (
        SimpleNamespace(casts_shadow=False, blocker_set=ALL_GROUPS),
        SimpleNamespace(casts_shadow=True, blocker_set=2),
    ):
        assert cast(snapshot, [view], points, 0, numbers, light=light).visibility == 1
    snapshot.instance_flags[1] = 1
    assert cast(snapshot, [view], points, 0, numbers).visibility == 1


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e5])
@pytest.mark.parametrize("offset", [0.0, 1e3])
def test_scale_and_place_do_not_matter(scale, offset):
    generator = np.random.default_rng(11)
    soup = make_soup(generator, 60, 0.5)
    points, numbers = put_on_ground(*generator.uniform(-3, 3, (2, 100)))
    view = make_view("SPOT")
    plain = cast(make_snapshot(GROUND, soup), [view], points, 0, numbers, texels=6)
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = offset * scale
    moved_view = np.eye(4)
    moved_view[:3, 3] = -matrix[:3, :3] @ [0, 0, 8.0] - matrix[:3, 3]
    moved = cast(
        make_snapshot(GROUND, soup, matrices=[matrix, matrix]),
        [View(True, view.texel_size, moved_view)],
        points @ matrix[:3, :3].T + matrix[:3, 3], 0, numbers, texels=6,
    )  # fmt: skip
    np.testing.assert_allclose(moved.visibility, plain.visibility, atol=1 / 32)
    assert np.mean(moved.visibility != plain.visibility) < 0.03


def test_samples_are_even_and_differ_between_pixels():
    a, b = PixelSamples(np.arange(50), 64).make(np.arange(50))
    assert a.shape == b.shape == (50, 64) and np.abs(a).max() <= 0.5 and np.abs(b).max() <= 0.5
    for coordinate in (a, b):
        for lattice in range(4):
            steps = np.diff(np.sort(coordinate[:, 16 * lattice : 16 * lattice + 16], axis=1), axis=1)
            np.testing.assert_allclose(steps, 1 / 16, atol=1e-12)
    assert len(np.unique(a[:, 0])) == 50 and abs(a.mean()) < 0.01
    assert PixelSamples(np.arange(3), 30).count == 32
