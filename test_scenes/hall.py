# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""hall: a long nave with thin fluted columns and louvred windows in the sun, about 505,000 triangles."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
import scene_kit as kit
from mathutils import Matrix

kBays = 12
kBayM = 3.0
kHalfWidthM = 5.5  # to the walls
kColumnLineM = 3.4  # to the rows of columns
kHeightM = 6.4
kFlutes = 20
kColumnRings = 50
kSlatsPerWindow = 17
kWallM = 0.4


def make_column() -> kit.Shape:
    """A slender fluted column with a turned base and capital; closed by its ends lying inside floor and beam."""
    sides = kFlutes * 8
    turn = np.arange(sides) * (2 * math.pi / sides)
    flute = 1.0 - 0.10 * np.abs(np.sin(turn * kFlutes / 2)) ** 0.7
    height = np.linspace(0.42, kHeightM - 0.62, kColumnRings)
    share = (height - height[0]) / (height[-1] - height[0])
    radius = 0.165 * (1 - 0.16 * share**1.8)
    ring = np.stack([np.cos(turn) * flute, np.sin(turn) * flute], axis=-1)
    positions = np.concatenate(
        [
            radius[:, None, None] * ring[None],
            np.broadcast_to(height[:, None, None], (kColumnRings, sides, 1)),
        ],
        axis=-1,
    )
    shaft = kit.Shape(positions.reshape(-1, 3), kit.grid(sides, kColumnRings, close_columns=True))
    swell = np.linspace(0, math.pi, 9)
    base = [
        (0.30, 0.0),
        (0.30, 0.16),
        *zip(0.25 + 0.04 * np.sin(swell), 0.16 + 0.14 * swell / math.pi, strict=True),
        (0.19, 0.36),
        (0.16, 0.44),
    ]
    top = kHeightM
    capital = [
        (0.13, top - 0.64),
        (0.17, top - 0.58),
        (0.15, top - 0.54),
        *zip(0.15 + 0.14 * np.sin(swell / 2) ** 2, top - 0.52 + 0.24 * swell / math.pi, strict=True),
        (0.30, top - 0.28),
        (0.30, top - 0.16),
    ]
    return kit.joined([shaft, kit.turned(base, 48), kit.turned(capital, 48)])


def make_window() -> kit.Shape:
    """One bay's window: a frame, mullions and tilted slats with rounded edges, in the plane x = 0."""
    width, sill, head = kBayM - 0.9, 1.0, kHeightM - 1.5
    parts = []
    for y in np.linspace(-width / 2, width / 2, 4):
        parts.append(kit.rounded_box((0.10, 0.05, head - sill), 0.012, 1).moved((0, y, (head + sill) / 2)))
    for z in (sill, head):
        parts.append(kit.rounded_box((0.14, width + 0.1, 0.08), 0.015, 1).moved((0, 0, z)))
    slat = kit.rounded_box((0.20, width, 0.018), 0.006, 1).transformed(Matrix.Rotation(math.radians(-24), 4, "Y"))
    for z in np.linspace(sill, head, kSlatsPerWindow + 2)[1:-1]:
        parts.append(slat.moved((0, 0, z)))
    return kit.joined(parts)


def make_wall(sign: int) -> kit.Shape:
    """A wall with an opening in each bay: piers, parapet and lintel as boxes."""
    length = kBays * kBayM
    x = sign * (kHalfWidthM + kWallM / 2)
    parts = [
        kit.box((kWallM, length, 0.98), (x, length / 2, 0.49)),
        kit.box((kWallM, length, 1.5), (x, length / 2, kHeightM - 0.73)),
    ]
    for bay in range(kBays + 1):
        pier = 0.9 if 0 < bay < kBays else 0.45
        y = min(max(bay * kBayM, 0.225), length - 0.225)
        parts.append(kit.box((kWallM, pier, kHeightM - 2.46), (x, y, kHeightM / 2 - 0.25)))
    return kit.joined(parts)


def make_roof() -> kit.Shape:
    """Beams over the columns, purlins across, and boards with an open strip of light along the ridge."""
    length = kBays * kBayM
    parts = []
    for sign in (-1, 1):
        parts.append(kit.rounded_box((0.42, length, 0.34), 0.03, 2).moved((sign * kColumnLineM, length / 2, kHeightM)))
        side = kHalfWidthM - 0.55
        boards = kit.box((side + 0.5, length, 0.06), (sign * (0.55 + (side + 0.5) / 2), length / 2, kHeightM + 0.42))
        parts.append(boards)
    for y in np.arange(0.5, kBays * 3) * (kBayM / 3):
        parts.append(kit.rounded_box((2 * kHalfWidthM + 0.6, 0.12, 0.22), 0.015, 2).moved((0, y, kHeightM + 0.27)))
    return kit.joined(parts)


def build(options: argparse.Namespace) -> None:
    length = kBays * kBayM
    stone = kit.new_material("Stone", (0.70, 0.66, 0.58))
    plaster = kit.new_material("Plaster", (0.74, 0.71, 0.66))
    wood = kit.new_material("Wood", (0.42, 0.27, 0.15))
    floor = kit.box((2 * kHalfWidthM + 2 * kWallM, length + 1, 0.2), (0, length / 2, -0.1))
    kit.add_object("Floor", floor, material=kit.new_material("Floor", (0.55, 0.50, 0.44), 0.4))
    column, window = kit.new_mesh("Column", make_column()), kit.new_mesh("Window", make_window())
    column.materials.append(stone)
    window.materials.append(wood)
    for sign, side in ((-1, "L"), (1, "R")):
        kit.add_object(f"Wall {side}", make_wall(sign), material=plaster)
        for bay in range(kBays):
            turn = Matrix.Rotation(0 if sign > 0 else math.pi, 4, "Z")
            place = Matrix.Translation((sign * (kHalfWidthM + kWallM / 2), (bay + 0.5) * kBayM, 0)) @ turn
            kit.add_object(f"Window {side}{bay:02d}", window, place=place)
            kit.add_object(f"Column {side}{bay:02d}", column, place=(sign * kColumnLineM, (bay + 0.5) * kBayM, 0))
    kit.add_object("Roof", make_roof(), material=wood)
    end = kit.box((2 * kHalfWidthM + 2 * kWallM, 0.3, kHeightM + 0.4), (0, length + 0.15, kHeightM / 2 + 0.2))
    kit.add_object("End wall", end, material=plaster)
    kit.add_light("SUN", "Sun", (9, -3, 9), (0.6, 1.6, 0), 4.5, color=(1.0, 0.90, 0.74), angle=math.radians(0.526))
    kit.add_camera((-1.5, -0.6, 1.75), (0.55, 12.0, 2.3), lens_mm=24)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__)
