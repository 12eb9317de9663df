# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""fence: wires, chain link and leaves in a low sun; thin things, and meshes that are open or have no thickness."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
import scene_kit as kit
from mathutils import Euler, Matrix, Vector

kPostGapM = 2.4
kPostCount = 5
kFenceHeightM = 1.6
kMeshM = 0.11  # diagonal of a chain-link cell
kWireM = 0.0022  # radius
kLeafCount = 900


def make_chain_link(width: float, height: float) -> kit.Shape:
    """Zig-zag wires standing side by side, each hooked into the next: open tubes of six sides."""
    half = kMeshM / 2
    count = int(height / half)
    parts = []
    for k in range(int(width / half)):
        steps = np.arange(count + 1)
        turn = (steps + k) % 2  # neighbours mirror each other, so that their bends meet and cells are diamonds
        x = k * half + np.where(turn == 0, 0.0, half) * 1.04
        y = np.where(turn == 0, -kWireM, kWireM)
        path = np.stack([x, y, steps * half], axis=-1)
        parts.append(kit.tube(path, kWireM, 6))
    return kit.joined(parts)


def make_wire(start: Vector, end: Vector, sag: float, radius: float) -> kit.Shape:
    """A wire that hangs between two points."""
    t = np.linspace(0, 1, 25)[:, None]
    path = np.array(start) * (1 - t) + np.array(end) * t
    path[:, 2] -= (sag * 4 * t * (1 - t))[:, 0]
    return kit.tube(path, radius, 6)


def make_barbs(start: Vector, end: Vector, gap: float = 0.16) -> kit.Shape:
    """Crossed pairs of short open tubes along a straight wire."""
    direction = end - start
    parts = []
    for k in range(1, int(direction.length / gap)):
        place = start + direction * (k * gap / direction.length)
        for angle in (0.7, 2.3):
            arm = Vector((0.2, math.cos(angle), math.sin(angle))) * 0.022
            parts.append(kit.tube([place - arm, place, place + arm], [0.0006, 0.0015, 0.0006], 5))
    return kit.joined(parts)


def make_leaf(length: float, width: float) -> kit.Shape:
    """A leaf without thickness, folded along its midrib and bent down towards the tip: an open patch of quads."""
    t, side = np.linspace(0, 1, 7), np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
    half = width / 2 * np.sin(math.pi * np.clip(t, 0.02, 0.98)) ** 0.75 * (1.15 - 0.3 * t)
    x = np.broadcast_to((t * length)[:, None], (7, 5))
    y = half[:, None] * side
    z = 0.35 * np.abs(y) - 0.35 * length * (t**2)[:, None]
    return kit.Shape(np.stack([x, y, z], axis=-1).reshape(-1, 3), kit.grid(5, 7))


def make_vine(random: np.random.Generator) -> tuple[list[kit.Shape], list[kit.Shape]]:
    """Stems climbing the fence, and the leaves on them."""
    stems, leaves = [], []
    for stem in range(7):
        x = 3.5 + stem * 0.36 + random.normal(0, 0.1)
        steps = 40
        rise = np.linspace(0, random.uniform(0.8, 1.65), steps)
        wander = np.cumsum(random.normal(0, 0.022, (steps, 2)), axis=0)
        path = np.stack([x + wander[:, 0] + 0.14 * np.sin(rise * 4 + stem), 0.02 + 0.3 * wander[:, 1], rise], axis=-1)
        stems.append(kit.tube(path, np.linspace(0.008, 0.0025, steps), 6))
        for _ in range(kLeafCount // 7):
            at = path[random.integers(2, steps)]
            turn = Euler((random.normal(0.9, 0.35), random.normal(0.2, 0.4), random.uniform(-math.pi, math.pi)))
            scale = Matrix.Scale(random.uniform(0.5, 1.15), 4)
            offset = random.normal(0, 0.025, 3)
            leaves.append(
                make_leaf(0.11, 0.075).transformed(
                    Matrix.Translation(Vector(at + offset)) @ turn.to_matrix().to_4x4() @ scale
                )
            )
    return stems, leaves


def scatter_leaves(random: np.random.Generator) -> kit.Shape:
    """Fallen leaves on the ground."""
    leaves = []
    for _ in range(140):
        place = Vector((random.uniform(0.5, 8.5), random.uniform(-3.2, 1.8), 0.022))
        turn = Euler((random.normal(0, 0.16), random.normal(0, 0.16) - 0.12, random.uniform(-math.pi, math.pi)))
        leaves.append(make_leaf(0.12, 0.08).transformed(Matrix.Translation(place) @ turn.to_matrix().to_4x4()))
    return kit.joined(leaves)


def add_fence(metal) -> None:
    length = kPostGapM * (kPostCount - 1)
    post = kit.joined(
        [
            kit.tube([(0, 0, -0.1), (0, 0, kFenceHeightM + 0.04)], 0.028, 20),
            kit.turned([(0.034, 1.62), (0.034, 1.65), (0.03, 1.672), (0.018, 1.685), (0.002, 1.69)], 20),
        ]
    )
    mesh = kit.new_mesh("Post", post, smooth=False)
    mesh.materials.append(metal)
    for k in range(kPostCount):
        kit.add_object(f"Post {k}", mesh, place=(k * kPostGapM, 0, 0))
    link = make_chain_link(length, kFenceHeightM - 0.1).moved((0, -0.03, 0.05))
    kit.add_object("Chain link", link, material=metal)
    wires = []
    for z, radius in ((0.08, 0.0022), (0.85, 0.0022), (1.53, 0.0022)):
        wires.append(make_wire(Vector((0, -0.03, z)), Vector((length, -0.03, z)), 0.0, radius))
    for k in range(kPostCount):  # arms that carry the barbed wire
        wires.append(kit.tube([(k * kPostGapM, 0, 1.62), (k * kPostGapM, 0.28, 1.93)], 0.012, 8))
    for y, z in ((0.10, 1.73), (0.19, 1.83), (0.28, 1.93)):
        for k in range(kPostCount - 1):
            start, end = Vector((k * kPostGapM, y, z)), Vector(((k + 1) * kPostGapM, y, z))
            wires += [make_wire(start, end, 0.006, 0.002), make_barbs(start, end)]
    kit.add_object("Wires", kit.joined(wires), material=metal)


def build(options: argparse.Namespace) -> None:
    random = np.random.default_rng(5)
    metal = kit.new_material("Zinc", (0.48, 0.50, 0.52), 0.45)
    green = kit.new_material("Leaf", (0.16, 0.33, 0.07))
    ground = kit.Shape([[-40, -40, 0], [50, -40, 0], [50, 50, 0], [-40, 50, 0]], [[0, 1, 2, 3]])
    kit.add_object("Ground", ground, material=kit.new_material("Concrete", (0.62, 0.60, 0.56)))
    kerb = kit.rounded_box((12, 0.16, 0.14), 0.02, 2).moved((4.8, 0, 0.0))
    kit.add_object("Kerb", kerb, material=kit.new_material("Kerb", (0.52, 0.50, 0.47)))
    add_fence(metal)
    stems, leaves = make_vine(random)
    kit.add_object("Stems", kit.joined(stems), material=kit.new_material("Bark", (0.20, 0.13, 0.08)))
    kit.add_object("Leaves", kit.joined(leaves), material=green)
    kit.add_object("Fallen leaves", scatter_leaves(random), material=kit.new_material("Autumn", (0.50, 0.20, 0.04)))
    kit.add_light("SUN", "Sun", (6.5, 5, 4.6), (4, 0, 0), 4.5, color=(1.0, 0.86, 0.66), angle=math.radians(0.526))
    kit.add_camera((2.3, -3.9, 1.75), (4.35, 0.0, 0.62), lens_mm=33)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__)
