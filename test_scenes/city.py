# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""city: a street of instanced houses, trees and cars in the sun, over a million triangles; camera in the street."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import numpy as np
import scene_kit as kit
from mathutils import Euler, Matrix, Vector

kFloorM = 3.3
kRoadM = 8.0
kPavementM = 3.6
kStreetM = 190.0
kSetbackM = 0.07  # of every other house: neighbours' pilasters and bands overlap, and must not share a plane
kLeafCount = 4000


def make_window(width: float, height: float) -> kit.Shape:
    """Frame, mullions, sill and lintel; the plane y = 0 is the wall, the street is at -y."""
    bar = 0.07
    parts = [kit.box((bar, 0.10, height), (x, -0.03, height / 2)) for x in (-width / 2, 0, width / 2)] + [
        kit.box((width, 0.08, bar), (0, -0.03, z)) for z in (bar / 2, height * 0.62, height - bar / 2)
    ]
    parts.append(kit.box((width + 0.3, 0.34, 0.09), (0, -0.13, -0.05)))
    parts.append(kit.box((width + 0.24, 0.24, 0.16), (0, -0.09, height + 0.08)))
    slat = kit.box((0.34, 0.012, 0.09)).transformed(Matrix.Rotation(math.radians(35), 4, "X"))
    for x in (-width / 2 - 0.24, width / 2 + 0.24):  # open shutters
        parts += [kit.box((0.04, 0.05, height), (x + side, -0.07, height / 2)) for side in (-0.19, 0.19)]
        parts += [slat.moved((x, -0.07, z)) for z in np.arange(0.06, height, 0.10)]
    return kit.joined(parts)


def make_balcony(width: float) -> kit.Shape:
    bars = [kit.box((0.02, 0.02, 0.95), (x, -0.95, 0.5)) for x in np.linspace(-width / 2, width / 2, 17)]
    sides = [kit.box((0.02, 0.02, 0.95), (s * width / 2, y, 0.5)) for s in (-1, 1) for y in np.linspace(-0.8, -0.1, 6)]
    rails = [kit.box((width + 0.05, 0.05, 0.05), (0, -0.95, 1.0)), kit.box((width + 0.2, 1.1, 0.12), (0, -0.52, -0.02))]
    return kit.joined(bars + sides + rails)


def make_house(bays: int, floors: int, bay_m: float, balconies: bool, gable: bool) -> tuple[kit.Shape, kit.Shape]:
    """Body and trim of a house, its front at y = 0 facing -y, centred in x. The body is set back behind pilasters and
    bands, so that windows lie in recesses without any cutting."""
    width, height, depth = bays * bay_m, floors * kFloorM + 0.6, 11.0
    body = [kit.box((width - 0.02, depth, height), (0, 0.3 + depth / 2, height / 2))]
    trim = []
    for bay in range(bays + 1):
        trim.append(kit.box((bay_m * 0.34, 0.3, height - 0.02), (bay * bay_m - width / 2, 0.15, height / 2)))
    window = make_window(bay_m * 0.5, 1.75).moved((0, 0.3, 0))
    for floor in range(floors):
        z = floor * kFloorM
        trim.append(kit.box((width + 0.1, 0.42, 0.28), (0, 0.12, z + kFloorM + 0.1)))
        for bay in range(bays):
            x = (bay + 0.5) * bay_m - width / 2
            trim.append(window.moved((x, 0, z + 0.95)))
            if balconies and floor > 0 and bay % 2 == floor % 2:
                trim.append(make_balcony(bay_m * 0.8).moved((x, 0.3, z + 0.35)))
    trim.append(kit.rounded_box((width + 0.5, 0.9, 0.35), 0.06, 2).moved((0, 0.2, height + 0.1)))
    for x in np.arange(-width / 2 + 0.3, width / 2, 0.5):
        trim.append(kit.box((0.16, 0.5, 0.22), (x, 0.0, height - 0.18)))
    if gable:
        rise = 3.2
        ridge = [
            [-width / 2, 0, 0],
            [width / 2, 0, 0],
            [width / 2, depth / 2, rise],
            [-width / 2, depth / 2, rise],
            [-width / 2, depth, 0],
            [width / 2, depth, 0],
        ]
        body.append(kit.Shape(ridge, [[0, 1, 2, 3], [3, 2, 5, 4]]).moved((0, 0.3, height + 0.27)))
        for x in (-width * 0.3, width * 0.22):
            body.append(kit.box((0.9, 0.7, 3.4), (x, depth * 0.4, height + 2.4)))
    else:
        body.append(kit.box((3.2, 3.0, 2.4), (width * 0.15, depth * 0.6, height + 1.2)))
        trim += [kit.box((0.03, 0.03, 0.9), (x, 0.6, height + 0.7)) for x in np.arange(-width / 2, width / 2, 0.22)]
        trim.append(kit.box((width, 0.05, 0.05), (0, 0.6, height + 1.15)))
    return kit.joined(body), kit.joined(trim)


def make_tree(random: np.random.Generator) -> tuple[kit.Shape, kit.Shape]:
    """Trunk with branches, and a crown of 4,000 leaves without thickness."""
    wood = [kit.tube([(0, 0, -0.1), (0.03, 0, 1.4), (0, 0.05, 2.8), (0.06, 0, 4.4)], [0.17, 0.13, 0.10, 0.03], 10)]
    tips = []
    for _ in range(14):
        angle, start = random.uniform(0, 2 * math.pi), random.uniform(2.0, 3.9)
        reach, rise = random.uniform(0.8, 1.7), random.uniform(0.6, 1.7)
        tip = Vector((reach * math.cos(angle), reach * math.sin(angle), start + rise))
        wood.append(kit.tube([(0, 0, start), tip * 0.5 + Vector((0, 0, start * 0.45)), tip], [0.05, 0.035, 0.01], 6))
        tips.append(tip)
    centre = np.array(tips)[random.integers(0, len(tips), kLeafCount)] + random.normal(0, 0.42, (kLeafCount, 3))
    quad = np.array([[-0.08, 0, 0], [0, -0.045, 0.015], [0.08, 0, 0], [0, 0.045, 0.015]])
    turns = np.array([np.array(Euler(random.uniform(-math.pi, math.pi, 3)).to_matrix()) for _ in range(kLeafCount)])
    leaves = np.einsum("nij,kj->nki", turns, quad) + centre[:, None]
    return kit.joined(wood), kit.Shape(leaves.reshape(-1, 3), np.arange(4 * kLeafCount).reshape(-1, 4))


def make_car() -> kit.Shape:
    parts = [
        kit.rounded_box((1.75, 4.2, 0.62), 0.16, 6).moved((0, 0, 0.62)),
        kit.rounded_box((1.55, 2.2, 0.60), 0.2, 6).moved((0, 0.15, 1.14)),
        kit.rounded_box((1.6, 0.18, 0.22), 0.05, 2).moved((0, -2.08, 0.46)),
        kit.rounded_box((1.6, 0.18, 0.22), 0.05, 2).moved((0, 2.08, 0.46)),
    ]
    wheel = kit.turned([(0.05, -0.11), (0.24, -0.11), (0.33, -0.07), (0.33, 0.07), (0.24, 0.11), (0.05, 0.11)], 24)
    lying = Matrix.Rotation(math.pi / 2, 4, "Y")
    for x in (-0.78, 0.78):
        for y in (-1.3, 1.35):
            parts.append(wheel.transformed(Matrix.Translation((x, y, 0.33)) @ lying))
    return kit.joined(parts)


def make_railing() -> kit.Shape:
    """Three metres of iron railing round a tree's bed."""
    bars = [kit.tube([(0, y, 0), (0, y, 0.62)], 0.011, 6) for y in np.linspace(-1.5, 1.5, 26)]
    rails = [kit.tube([(0, -1.5, z), (0, 1.5, z)], 0.016, 8) for z in (0.12, 0.6)]
    return kit.joined(bars + rails)


def make_lamp() -> kit.Shape:
    pole = kit.turned([(0.14, 0), (0.14, 0.5), (0.07, 0.62), (0.055, 4.6), (0.03, 4.7)], 16)
    arc = [(0.0, 0.0, 4.6), (0.0, 0.0, 4.9), (0.25, 0.0, 5.15), (0.7, 0.0, 5.25), (1.1, 0.0, 5.2)]
    head = kit.turned([(0.02, 5.28), (0.1, 5.25), (0.26, 5.12), (0.24, 5.08), (0.02, 5.08)], 20).moved((1.15, 0, -0.02))
    return kit.joined([pole, kit.tube(arc, 0.035, 10), head])


def new_kind(name: str, *parts: tuple[kit.Shape, object]) -> bpy.types.Collection:
    """A collection to be instanced, outside the scene; one object for each material."""
    kind = bpy.data.collections.new(name)
    for k, (shape, material) in enumerate(parts):
        kit.add_object(f"{name} {k}", shape, material=material, collection=kind)
    return kind


def place_kind(kind: bpy.types.Collection, place: Matrix) -> None:
    thing = kit.add_object(kind.name, None, place=place)
    thing.instance_type, thing.instance_collection = "COLLECTION", kind


def line_up_houses(random: np.random.Generator) -> None:
    walls = [(0.62, 0.50, 0.36), (0.55, 0.30, 0.22), (0.66, 0.62, 0.54), (0.45, 0.47, 0.50), (0.68, 0.56, 0.30)]
    trim = kit.new_material("Trim", (0.70, 0.68, 0.63))
    plans = [
        (4, 5, 3.0, True, False),
        (3, 4, 3.2, False, True),
        (5, 6, 2.6, True, False),
        (4, 3, 2.8, False, True),
        (3, 6, 3.4, False, False),
    ]
    kinds = []
    for k, (plan, color) in enumerate(zip(plans, walls, strict=True)):
        body, parts = make_house(*plan)
        name = f"House {k}"
        kinds.append((new_kind(name, (body, kit.new_material(name, color)), (parts, trim)), plan[0] * plan[2]))
    edge = kRoadM / 2 + kPavementM
    for sign in (-1, 1):
        along, last, setback = -26.0, -1, 0.0
        while along < kStreetM:
            pick = int(random.integers(len(kinds)))
            pick = (pick + 1) % len(kinds) if pick == last else pick
            kind, width = kinds[pick]
            turn = Matrix.Rotation(math.pi / 2 if sign > 0 else -math.pi / 2, 4, "Z")
            turn = turn @ Matrix.Rotation(math.pi, 4, "Z")
            place_kind(kind, Matrix.Translation((sign * (edge + setback), along + width / 2, 0.14)) @ turn)
            setback = kSetbackM - setback
            along += width + (0.02 if random.random() < 0.8 else 5.0)
            last = pick


def line_the_street(random: np.random.Generator) -> None:
    bark, leaf = kit.new_material("Bark", (0.16, 0.11, 0.07)), kit.new_material("Leaf", (0.14, 0.30, 0.06))
    trees = [new_kind(f"Tree {k}", *zip(make_tree(random), (bark, leaf), strict=True)) for k in range(3)]
    iron = kit.new_material("Iron", (0.06, 0.07, 0.07), 0.4)
    lamp, railing = new_kind("Lamp", (make_lamp(), iron)), new_kind("Railing", (make_railing(), iron))
    paints = [(0.55, 0.05, 0.04), (0.06, 0.14, 0.32), (0.62, 0.62, 0.60), (0.05, 0.05, 0.05), (0.50, 0.36, 0.06)]
    cars = [new_kind(f"Car {k}", (make_car(), kit.new_material(f"Paint {k}", c, 0.3))) for k, c in enumerate(paints)]
    for sign in (-1, 1):
        for k, along in enumerate(np.arange(-12, kStreetM, 7.5)):
            x = sign * (kRoadM / 2 + 0.75)
            turn = Matrix.Rotation(random.uniform(0, 2 * math.pi), 4, "Z") @ Matrix.Scale(random.uniform(0.85, 1.25), 4)
            place_kind(trees[k % 3], Matrix.Translation((x, along, 0.14)) @ turn)
            place_kind(railing, Matrix.Translation((x + sign * 0.75, along, 0.14)))
            if k % 3 == 1:
                facing = Matrix.Rotation(math.pi if sign > 0 else 0, 4, "Z")
                place_kind(lamp, Matrix.Translation((x, along + 3.7, 0.14)) @ facing)
        for along in np.arange(-10, kStreetM, 5.6):
            if random.random() < 0.72 and not (sign > 0 and along < 9):
                turn = Matrix.Rotation((0 if sign > 0 else math.pi) + random.normal(0, 0.03), 4, "Z")
                place = Matrix.Translation((sign * (kRoadM / 2 - 1.15), along + random.normal(0, 0.3), 0))
                place_kind(cars[random.integers(len(cars))], place @ turn)


def add_landmark(stone, slate) -> None:
    """A tower that closes the street."""
    parts = [kit.box((9, 9, 26), (0, 0, 13))]
    for x in (-3.1, 0, 3.1):
        parts += [kit.rounded_box((0.9, 0.5, 24), 0.08, 2).moved((x, -4.6, 12)), kit.box((1.2, 0.4, 5), (x, -4.5, 21))]
    for z in (8, 16, 25.5):
        parts.append(kit.rounded_box((10, 10, 0.6), 0.12, 2).moved((0, 0, z)))
    kit.add_object("Tower", kit.joined(parts), material=stone, place=(0, kStreetM + 16, 0))
    spire = kit.turned([(6.2, 26), (5.6, 26.6), (0.9, 44), (0.35, 45.5), (0.02, 49)], 8)
    kit.add_object("Spire", spire, material=slate, place=(0, kStreetM + 16, 0))


def build(options: argparse.Namespace) -> None:
    random = np.random.default_rng(29)
    far = 400.0
    ground = kit.Shape([[-far, -far, 0], [far, -far, 0], [far, far, 0], [-far, far, 0]], [[0, 1, 2, 3]])
    kit.add_object("Road", ground, material=kit.new_material("Asphalt", (0.30, 0.30, 0.31)))
    slab = kit.new_material("Slab", (0.52, 0.50, 0.47))
    length = kStreetM + 40
    for sign in (-1, 1):
        kerb = kit.rounded_box((kPavementM + 12, length, 0.28), 0.02, 2)
        kit.add_object(
            "Pavement", kerb, material=slab, place=(sign * (kRoadM / 2 + kPavementM / 2 + 6), length / 2 - 30, 0)
        )
    line_up_houses(random)
    line_the_street(random)
    add_landmark(kit.new_material("Stone", (0.58, 0.54, 0.46)), kit.new_material("Slate", (0.16, 0.20, 0.24)))
    kit.add_light("SUN", "Sun", (7.5, -12, 19), (0, 0, 0), 4.0, color=(1.0, 0.91, 0.77), angle=math.radians(0.526))
    bpy.context.scene.world.color = (0.16, 0.22, 0.32)
    kit.add_camera((1.35, -17.0, 1.75), (0.2, 14.0, 4.1), lens_mm=26)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__)
