# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""door: a glazed door's shadow over a smooth hare, a receiver without a flat spot; 37,982 triangles."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import scene_kit as kit
from mathutils import Euler, Matrix, Vector

kDoorM = (1.0, 0.045, 2.0)  # width, thickness, height
kRailM = 0.11  # width of the frame
kBarM = 0.028  # of the bars between the panes
kPanes = (3, 4)  # across, up
kSolidM = 0.62  # height of the panel below the panes
# Ellipsoids of the hare: half axes, middle, turn in degrees, cells per side of the ball.
kHare = [
    ((0.34, 0.46, 0.37), (0.0, 0.0, 0.36), (0, 0, 0), 28),  # body
    ((0.24, 0.22, 0.27), (0.0, -0.33, 0.46), (14, 0, 0), 20),  # chest
    ((0.19, 0.23, 0.20), (0.0, -0.50, 0.80), (-12, 0, 0), 22),  # head
    ((0.065, 0.045, 0.30), (-0.09, -0.41, 1.17), (-16, -12, 0), 16),  # ears
    ((0.065, 0.045, 0.30), (0.10, -0.39, 1.16), (-22, 16, 0), 16),
    ((0.12, 0.30, 0.11), (-0.26, -0.02, 0.12), (0, 0, 8), 14),  # hind feet
    ((0.12, 0.30, 0.11), (0.26, -0.02, 0.12), (0, 0, -8), 14),
    ((0.075, 0.17, 0.08), (-0.12, -0.55, 0.08), (0, 0, 4), 12),  # fore feet
    ((0.075, 0.17, 0.08), (0.12, -0.55, 0.08), (0, 0, -4), 12),
    ((0.12, 0.12, 0.12), (0.0, 0.47, 0.28), (0, 0, 0), 14),  # tail
]


def make_hare() -> kit.Shape:
    parts = []
    for half_axes, middle, turn, cells in kHare:
        stretch = Matrix.Diagonal(Vector((*half_axes, 1)))
        turned = Euler([math.radians(angle) for angle in turn]).to_matrix().to_4x4()
        parts.append(kit.ball(cells).transformed(Matrix.Translation(middle) @ turned @ stretch))
    return kit.joined(parts)


def make_door() -> kit.Shape:
    """Stiles, rails, bars and the panel, of boxes; its lower edge is the x axis, its hinge at the origin."""
    width, thickness, height = kDoorM

    def slab(x: tuple[float, float], z: tuple[float, float], depth: float = thickness) -> kit.Shape:
        return kit.box((x[1] - x[0], depth, z[1] - z[0]), ((x[0] + x[1]) / 2, 0, (z[0] + z[1]) / 2))

    parts = [slab((0, kRailM), (0, height)), slab((width - kRailM, width), (0, height))]
    inner = (kRailM, width - kRailM)
    glass = (kSolidM, height - kRailM)
    parts += [slab(inner, (0, kSolidM)), slab(inner, (glass[1], height))]
    columns, rows = kPanes
    for k in range(1, columns):
        middle = inner[0] + (inner[1] - inner[0]) * k / columns
        parts.append(slab((middle - kBarM / 2, middle + kBarM / 2), glass, thickness * 0.6))
    for k in range(1, rows):
        middle = glass[0] + (glass[1] - glass[0]) * k / rows
        parts.append(slab(inner, (middle - kBarM / 2, middle + kBarM / 2), thickness * 0.5))
    parts.append(kit.ball(10).transformed(Matrix.Translation((width - 0.055, -0.07, 0.98)) @ Matrix.Scale(0.035, 4)))
    return kit.joined(parts)


def build(options: argparse.Namespace) -> None:
    del options
    half = 30.0
    floor = kit.Shape([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], [[0, 1, 2, 3]])
    kit.add_object("Floor", floor, material=kit.new_material("Tiles", (0.64, 0.62, 0.58)))
    hare = kit.new_mesh("Hare", make_hare(), smooth=True)
    place = Matrix.Translation((0.35, 0.1, 0)) @ Matrix.Rotation(math.radians(52), 4, "Z")
    kit.add_object("Hare", hare, material=kit.new_material("Clay", (0.66, 0.52, 0.40)), place=place)
    hinge = Matrix.Translation((-1.15, 0.35, 0.02)) @ Matrix.Rotation(math.radians(-68), 4, "Z")
    kit.add_object("Door", make_door(), material=kit.new_material("Paint", (0.22, 0.36, 0.40)), place=hinge)
    kit.add_light(
        *("SPOT", "Lamp", (-3.9, -0.6, 2.7), (0.3, 0.0, 0.55), 1300.0),
        **{"color": (1.0, 0.92, 0.80), "spot_size": math.radians(52), "spot_blend": 0.2, "shadow_soft_size": 0.05},
    )
    kit.add_camera((1.5, -4.3, 2.0), (0.2, 0.05, 0.66), lens_mm=40)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__)
