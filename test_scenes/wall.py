# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""wall: a wall's shadow over a statue and the floor, where filtered maps let light through; 41,390 triangles."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import knot
import scene_kit as kit
from mathutils import Matrix

kWallHeightM = 1.9
kWallX, kWallEndY = -1.4, -0.27
kStatueTriangles = 40_000


def make_wall() -> kit.Shape:
    """A tall slab whose end is in line with lamp and statue, so that the edge of its shadow runs up the pedestal and
    through the pedestal's own shadow; a low one beyond."""
    tall = kit.box((0.16, 1.7, kWallHeightM), (kWallX, kWallEndY - 0.85, kWallHeightM / 2))
    low = kit.box((0.16, 1.4, 0.4), (kWallX, kWallEndY + 0.7, 0.2))
    return kit.joined([tall, low])


def make_pedestal() -> kit.Shape:
    radii = [0.46, 0.46, 0.36, 0.32, 0.30, 0.38, 0.38, 0.01]
    heights = [0.0, 0.10, 0.14, 0.20, 0.34, 0.40, 0.44, 0.44]
    return kit.turned(list(zip(radii, heights, strict=True)), 96)


def build(options: argparse.Namespace) -> None:
    del options
    half = 30.0
    floor = kit.Shape([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], [[0, 1, 2, 3]])
    kit.add_object("Floor", floor, material=kit.new_material("Floor", (0.66, 0.65, 0.62)))
    kit.add_object("Wall", make_wall(), material=kit.new_material("Brick", (0.58, 0.30, 0.22)))
    kit.add_object("Pedestal", make_pedestal(), material=kit.new_material("Stone", (0.60, 0.58, 0.52)))
    statue = kit.new_mesh("Statue", knot.make_knot(kStatueTriangles, size=1.25))
    place = Matrix.Translation((0, 0, 0.44)) @ Matrix.Rotation(math.radians(62), 4, "Z")
    kit.add_object("Statue", statue, material=kit.new_material("Jade", (0.30, 0.55, 0.36)), place=place)
    kit.add_light(
        *("SPOT", "Lamp", (-4.6, -0.9, 4.2), (0.3, 0.0, 0.5), 1600.0),
        **{"color": (1.0, 0.93, 0.82), "spot_size": math.radians(58), "spot_blend": 0.2, "shadow_soft_size": 0.05},
    )
    kit.add_camera((2.0, -4.5, 2.5), (0.25, 0.0, 0.66), lens_mm=38)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__)
