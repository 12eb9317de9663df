# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""box: one cube over a plane, one light. The shadow's outline is known in closed form."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import scene_kit as kit
from mathutils import Matrix

# What a test needs to work the outline out. The cube's lower face lies `kGapM` above the plane z = 0.
kCubeSizeM = 1.6
kGapM = 0.35
kTurnDeg = 27.0
kPlaneSizeM = 60.0
kLightPlace = (-1.9, -3.6, 5.4)
kTarget = (0.4, 0.5, 0.5)


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--light", choices=["spot", "sun", "point", "area"], default="spot", help="kind of the one light"
    )


def add_key_light(kind: str) -> None:
    energy = {"sun": 3.0}.get(kind, 900.0)
    settings = {
        "spot": {"spot_size": math.radians(64), "spot_blend": 0.2, "shadow_soft_size": 0.08},
        "sun": {"angle": math.radians(0.526)},
        "point": {"shadow_soft_size": 0.08},
        "area": {"shape": "SQUARE", "size": 0.5},
    }[kind]
    kit.add_light(kind.upper(), "Key", kLightPlace, kTarget, energy, color=(1.0, 0.93, 0.82), **settings)


def build(options: argparse.Namespace) -> None:
    half = kPlaneSizeM / 2
    plane = kit.Shape([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], [[0, 1, 2, 3]])
    kit.add_object("Plane", plane, material=kit.new_material("Plaster", (0.72, 0.70, 0.66)))
    place = Matrix.Translation((0, 0, kGapM + kCubeSizeM / 2)) @ Matrix.Rotation(math.radians(kTurnDeg), 4, "Z")
    cube = kit.box((kCubeSizeM,) * 3)
    kit.add_object("Cube", cube, material=kit.new_material("Clay", (0.75, 0.32, 0.18)), place=place)
    add_key_light(options.light)
    kit.add_camera((4.9, -5.6, 4.6), (0.55, 0.75, 0.55), lens_mm=42)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__, add_options)
