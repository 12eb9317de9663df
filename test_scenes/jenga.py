# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""jenga: a leaning tower of bevelled blocks in a spot light, about 17,800 triangles."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
import scene_kit as kit
from mathutils import Matrix, Vector

kBlock = (0.75, 0.25, 0.15)  # length, width, height, in units of ten centimetres
kBevel = 0.018
kLevelCount = 18
kPulled = {(5, 0), (7, 2), (10, 1), (12, 0)}  # (level, place): drawn half out of the tower
kMissing = {(3, 1), (6, 0), (9, 2), (11, 1), (13, 0), (14, 2)}  # taken out and lying about
kLoose = [  # x, y, turn in degrees, tilt in degrees: on the table, two of them leaning on the tower
    (0.85, -0.62, 24, 0),
    (1.30, 0.02, 71, 0),
    (0.74, -1.20, -38, 0),
    (-0.92, -0.72, 12, 0),
    (-0.78, 0.56, 102, 0),
    (1.62, -0.78, -8, 0),
    (0.02, -1.24, 64, 0),
]
kLeaning = [(0.64, 0.05, 0, 62), (-0.10, -0.63, -90, 58)]
kGroundCells = 7


def place_tower(random: np.random.Generator) -> list[Matrix]:
    """World matrices of the blocks that stand in the tower, level by level, with a growing lean."""
    length, width, height = kBlock
    places = []
    for level in range(kLevelCount):
        turn = Matrix.Rotation(math.pi / 2 * (level % 2), 4, "Z")
        lean = Vector((0.0011, -0.0004, 0)) * level**1.6
        top = level == kLevelCount - 1
        for place in range(3):
            if (level, place) in kMissing or (top and place == 1):
                continue
            out = 0.34 * length if (level, place) in kPulled else random.normal(0, 0.008)
            offset = Matrix.Translation((out, (place - 1) * width * 1.02, 0))
            twist = Matrix.Rotation(random.normal(0, 0.014), 4, "Z")
            lift = Matrix.Translation(lean + Vector((0, 0, height * (level + 0.5))))
            places.append(lift @ turn @ offset @ twist)
    return places


def place_loose() -> list[Matrix]:
    """Blocks on the table and two that lean on the tower."""
    height = kBlock[2]
    flat = [
        Matrix.Translation((x, y, height / 2)) @ Matrix.Rotation(math.radians(turn), 4, "Z") for x, y, turn, _ in kLoose
    ]
    leaning = []
    for x, y, turn, tilt in kLeaning:
        angle = math.radians(tilt)
        lift = kBlock[0] / 2 * math.sin(angle) + height / 2 * math.cos(angle)
        upright = Matrix.Rotation(math.radians(turn), 4, "Z") @ Matrix.Rotation(angle, 4, "Y")
        leaning.append(Matrix.Translation((x, y, lift)) @ upright)
    top = kBlock[2] * kLevelCount
    crown = [
        Matrix.Translation((0.10, -0.03, top + height / 2)) @ Matrix.Rotation(math.radians(31), 4, "Z"),
        Matrix.Translation((0.14, 0.02, top + 1.5 * height)) @ Matrix.Rotation(math.radians(-22), 4, "Z"),
        Matrix.Translation((0.13, 0.0, top + 2.5 * height)) @ Matrix.Rotation(math.radians(48), 4, "Z"),
    ]
    return flat + leaning + crown


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--hide-blocks", action="store_true", help="the camera sees only the table and the shadows on it"
    )


def build(options: argparse.Namespace) -> None:
    random = np.random.default_rng(17)
    shape = kit.rounded_box(kBlock, kBevel, steps=2)
    woods = [
        kit.new_material(f"Wood {k}", color)
        for k, color in enumerate([(0.72, 0.50, 0.27), (0.66, 0.43, 0.21), (0.78, 0.58, 0.34), (0.60, 0.37, 0.18)])
    ]
    meshes = []
    for k, wood in enumerate(woods):
        mesh = kit.new_mesh(f"Block {k}", shape)
        mesh.materials.append(wood)
        meshes.append(mesh)
    for k, place in enumerate(place_tower(random) + place_loose()):
        block = kit.add_object(f"Block {k:02d}", meshes[random.integers(len(meshes))], place=place)
        block.visible_camera = not options.hide_blocks
    half = 16.0
    axis = np.linspace(-half, half, kGroundCells + 1)
    x, y = np.meshgrid(axis, axis)
    table = kit.Shape(np.stack([x, y, np.zeros_like(x)], axis=-1), kit.grid(kGroundCells + 1, kGroundCells + 1))
    kit.add_object("Table", table, material=kit.new_material("Table", (0.55, 0.57, 0.58)))
    kit.add_light(
        "SPOT",
        "Lamp",
        (-3.4, -3.4, 8.2),
        (0.6, 0.4, 0.8),
        3000,
        color=(1.0, 0.91, 0.78),
        spot_size=math.radians(46),
        spot_blend=0.35,
        shadow_soft_size=0.05,
    )
    kit.add_camera((2.9, -6.6, 4.3), (0.62, 0.1, 1.42), lens_mm=37)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__, add_options)
