# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""knot: a rippled trefoil knot of any number of triangles on a plane, for times that grow with the scene."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
import scene_kit as kit
from mathutils import Matrix

kFewestTriangles = 100
kSizeM = 2.0  # largest extent
kRingsPerSide = 6  # rings along the knot for each corner of a ring: makes triangles about as long as wide


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--triangles", type=int, default=100_000, help="of the knot, about (default: 100000)")


def make_knot(triangle_count: int, size: float = kSizeM) -> kit.Shape:
    """A closed tube along the (2, 3) torus knot, upright, standing on z = 0 and centred; quads."""
    sides = max(3, round(math.sqrt(triangle_count / (2 * kRingsPerSide))))
    rings = max(8, round(triangle_count / (2 * sides)))
    turn = np.arange(rings) * (2 * math.pi / rings)
    reach = 2 + np.cos(3 * turn)
    path = np.stack([reach * np.cos(2 * turn), np.sin(3 * turn), reach * np.sin(2 * turn)], axis=-1)
    shape = kit.tube(path, 0.46 + 0.07 * np.sin(24 * turn), sides, closed=True)
    low, high = shape.positions.min(axis=0), shape.positions.max(axis=0)
    centre = (low + high) / 2
    return kit.Shape((shape.positions - [centre[0], centre[1], low[2]]) * (size / (high - low).max()), shape.faces)


def build(options: argparse.Namespace) -> None:
    if options.triangles < kFewestTriangles:
        raise ValueError(f"--triangles {options.triangles}: a knot takes at least {kFewestTriangles}")
    mesh = kit.new_mesh("Knot", make_knot(options.triangles))
    place = Matrix.Rotation(math.radians(-20), 4, "Z")
    kit.add_object("Knot", mesh, material=kit.new_material("Glaze", (0.16, 0.36, 0.52)), place=place)
    half = 40.0
    plane = kit.Shape([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], [[0, 1, 2, 3]])
    kit.add_object("Plane", plane, material=kit.new_material("Plaster", (0.70, 0.69, 0.66)))
    target = (0.3, 0.2, 0.8)
    kit.add_light(
        *("SPOT", "Key", (-2.7, -2.8, 4.8), target, 1100.0),
        **{"color": (1.0, 0.94, 0.84), "spot_size": math.radians(50), "spot_blend": 0.3, "shadow_soft_size": 0.06},
    )
    kit.add_camera((3.0, -5.0, 3.1), target, lens_mm=44)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__, add_options)
