# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""blades: a fan of flat blades over a plane in the sun; their shadows' edges lie at every angle to a map's rows."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
import scene_kit as kit

kBlades = 18
kInnerM, kOuterM = 0.35, 2.6  # where the blades begin and end
kHeightM = 0.9
kThicknessM = 0.02
kOpen = 0.5  # part of the turn that is open


def make_blades() -> kit.Shape:
    """Flat wedges round the z axis, closed, of equal width in angle."""
    blades = []
    for k in range(kBlades):
        start = 2 * math.pi * (k + 0.1) / kBlades
        angles = np.array([start, start + 2 * math.pi * (1 - kOpen) / kBlades])
        ring = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        corners = np.concatenate([kInnerM * ring, kOuterM * ring[::-1]])  # counter-clockwise seen from below
        low = np.column_stack([corners, np.full(4, kHeightM)])
        high = low + np.array([0, 0, kThicknessM])
        sides = [[a, a + 4, (a + 1) % 4 + 4, (a + 1) % 4] for a in range(4)]
        blades.append(kit.Shape(np.concatenate([low, high]), [[0, 1, 2, 3], [7, 6, 5, 4], *sides]))
    return kit.joined(blades)


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--hide-blades", action="store_true", help="the camera sees only the plane and the shadows on it"
    )


def build(options: argparse.Namespace) -> None:
    half = 30.0
    plane = kit.Shape([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], [[0, 1, 2, 3]])
    kit.add_object("Plane", plane, material=kit.new_material("Plaster", (0.70, 0.69, 0.66)))
    blades = kit.add_object("Blades", make_blades(), material=kit.new_material("Steel", (0.45, 0.50, 0.56), 0.4))
    blades.visible_camera = not options.hide_blades
    kit.add_light("SUN", "Sun", (-2.0, -1.1, 4.0), (0, 0, 0), 3.0, color=(1.0, 0.95, 0.88), angle=math.radians(0.526))
    kit.add_camera((1.4, -5.6, 5.0), (0.35, 0.1, 0.0), lens_mm=40)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__, add_options)
