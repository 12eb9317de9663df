# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""bumpy: a grille's shadow over bumps whose triangles are smaller than pixels; 961,752 triangles.

The receiver is a height field. Seen in 1280 x 720 pixels most of its triangles cover less than a pixel, and the nearest
lie within 4 x 4, so that a pixel's centre tells little of what its square holds. `--bumps 0` is the same field without
heights: then every pixel is flat again, however small the triangles.
"""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
import scene_kit as kit
from mathutils import Matrix

kColumns, kRows = 800, 600  # cells
kWidthM, kDepthM = 4.0, 3.0
kBumpsM = 0.022  # root of the mean square of the heights
kWaves = 60
kLengthsM = (0.07, 0.5)  # of the waves, crest to crest
kGrilleM = 0.62  # radius
kGrillePlace = (-0.62, 0.2, 0.72)
kTarget = (0.05, 0.0, 0.06)


def make_field(bumps_m: float) -> kit.Shape:
    """A welded grid with the heights of waves of many lengths, directions and phases, shorter ones flatter."""
    random = np.random.default_rng(9)
    x = np.linspace(-kWidthM / 2, kWidthM / 2, kColumns + 1)
    y = np.linspace(-kDepthM / 2, kDepthM / 2, kRows + 1)[:, None]
    height = np.zeros((kRows + 1, kColumns + 1))
    for length in np.geomspace(*kLengthsM, kWaves):
        turn, phase = random.uniform(0, 2 * math.pi, 2)
        way = 2 * math.pi / length * (math.cos(turn) * x + math.sin(turn) * y)
        height += length * np.sin(way + phase)
    height *= bumps_m / height.std()
    place = np.stack(np.broadcast_arrays(x, y, height), axis=-1)
    return kit.Shape(place.reshape(-1, 3), kit.grid(kColumns + 1, kRows + 1))


def make_grille() -> kit.Shape:
    """A ring with bars across that turn and thin out from the first to the last."""
    turn = np.linspace(0, 2 * math.pi, 96, endpoint=False)
    ring = np.stack([kGrilleM * np.cos(turn), kGrilleM * np.sin(turn), np.zeros(len(turn))], axis=-1)
    parts = [kit.tube(ring, 0.03, 8, closed=True)]
    for k in range(9):
        angle = math.radians(2.5 * (k - 4))
        along = np.array([math.sin(angle), math.cos(angle), 0.0])
        across = np.array([along[1], -along[0], 0.0])
        aside = kGrilleM * (k - 4) / 4.6
        reach = math.sqrt(kGrilleM**2 - aside**2)
        ends = [aside * across + t * reach * along for t in (-1.0, 0.0, 1.0)]
        parts.append(kit.tube(ends, 0.028 - 0.0028 * k, 6))
    return kit.joined(parts)


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--light", choices=["sun", "spot"], default="sun", help="kind of the one light")
    parser.add_argument(
        "--bumps", metavar="M", type=float, default=kBumpsM, help=f"mean height in metres ({kBumpsM}); 0: flat"
    )
    parser.add_argument("--hide-grille", action="store_true", help="the camera sees only the field and its shadows")


def build(options: argparse.Namespace) -> None:
    if not 0 <= options.bumps <= 1:
        raise ValueError(f"--bumps {options.bumps:g} is not from 0 to 1 metre")
    kit.add_object("Field", make_field(options.bumps), material=kit.new_material("Plaster", (0.70, 0.69, 0.66)))
    place = Matrix.Translation(kGrillePlace) @ Matrix.Rotation(math.radians(-20), 4, (0.4, 1.0, 0.3))
    grille = kit.add_object("Grille", make_grille(), material=kit.new_material("Iron", (0.30, 0.31, 0.34)), place=place)
    grille.visible_camera = not options.hide_grille
    settings = {"angle": math.radians(0.526)}
    if options.light == "spot":
        settings = {"spot_size": math.radians(66), "spot_blend": 0.2, "shadow_soft_size": 0.04}
    energy = 3.0 if options.light == "sun" else 900.0
    kit.add_light(
        options.light.upper(), "Key", (-2.6, 0.9, 3.4), (0.1, -0.2, 0.2), energy, color=(1.0, 0.95, 0.88), **settings
    )
    kit.add_camera((1.0, -5.0, 3.0), kTarget, lens_mm=46)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__, add_options)
