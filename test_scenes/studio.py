# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""studio: a rigged, animated figure on a plinth, lit by a sun, a spot, a point and an area light; the preview scene."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import mannequin
import numpy as np
import scene_kit as kit
from mathutils import Matrix

kScreenPlace = (-2.75, 0.62)


def make_backdrop() -> kit.Shape:
    """A floor that bends up into a wall."""
    bend = np.linspace(0, math.pi / 2, 24)
    radius, back = 1.6, 3.4
    profile = [
        (-9.0, 0.0),
        *zip(back - radius + radius * np.sin(bend), radius - radius * np.cos(bend), strict=True),
        (back, 6.5),
    ]
    y, z = np.array(profile).T
    x = np.linspace(-11, 11, 12)
    positions = np.stack(np.broadcast_arrays(x[None, :], y[:, None], z[:, None]), axis=-1)
    return kit.Shape(positions.reshape(-1, 3), kit.grid(len(x), len(y)))


def make_screen_panel(width: float, height: float) -> kit.Shape:
    """One leaf of a folding screen: a frame filled with a lattice; hinged at x = 0."""
    post, bar = 0.05, 0.018
    parts = [
        kit.rounded_box((post, post, height), 0.008, 2).moved((x, 0, height / 2 + 0.06)) for x in (post / 2, width)
    ]
    for z in (0.10, 0.62, height + 0.03):  # rails end inside the posts, and lie behind their faces
        parts.append(kit.rounded_box((width, 0.8 * post, post), 0.008, 2).moved((width / 2 + post / 4, 0, z)))
    for x in np.linspace(0, width, 8)[1:-1]:
        parts.append(kit.box((bar, bar, height - 0.62), (x, 0, (height + 0.66) / 2)))
    for z in np.linspace(0.62, height, 12)[1:-1]:
        parts.append(kit.box((width, bar * 0.9, bar), (width / 2, 0, z)))
    parts.append(kit.box((width, 0.012, 0.50), (width / 2, 0, 0.36)))
    return kit.joined(parts)


def make_lantern() -> kit.Shape:
    """A globe of thin ribs and rings round a lamp, on a turned stand."""
    parts = []
    for k in range(14):
        turn = Matrix.Rotation(k * 2 * math.pi / 14, 4, "Z")
        bow = np.linspace(0.30, math.pi - 0.30, 17)
        rib = [(0.24 * math.sin(a), 0, 0.25 * math.cos(a)) for a in bow]
        parts.append(kit.tube(rib, 0.007, 8).transformed(turn))
    for a in (0.30, 0.62, 1.05, 1.57, 2.09, 2.52, 2.84):
        around = np.linspace(0, 2 * math.pi, 48, endpoint=False)
        ring = np.column_stack(
            [0.24 * math.sin(a) * np.cos(around), 0.24 * math.sin(a) * np.sin(around), np.full(48, 0.25 * math.cos(a))]
        )
        parts.append(kit.tube(ring, 0.007, 8, closed=True))
    globe = kit.joined(parts).moved((0, 0, 1.02))
    stand = kit.turned(
        [
            (0.001, 0),
            (0.19, 0),
            (0.19, 0.025),
            (0.05, 0.06),
            (0.03, 0.12),
            (0.022, 0.4),
            (0.035, 0.46),
            (0.022, 0.52),
            (0.022, 0.70),
            (0.06, 0.76),
            (0.075, 0.78),
            (0.001, 0.78),
        ],
        40,
    )
    return kit.joined([globe, stand])


def make_stool() -> kit.Shape:
    seat = kit.turned([(0.001, 0.44), (0.17, 0.44), (0.19, 0.455), (0.19, 0.475), (0.17, 0.49), (0.001, 0.49)], 48)
    parts = [seat]
    for k in range(4):
        angle = math.pi / 4 + k * math.pi / 2
        foot, top = 0.20, 0.12
        path = [
            (foot * math.cos(angle), foot * math.sin(angle), 0.0),
            (top * math.cos(angle), top * math.sin(angle), 0.45),
        ]
        parts.append(kit.tube(np.linspace(path[0], path[1], 5), [0.013, 0.018, 0.021, 0.018, 0.014], 16))
    around = np.linspace(0, 2 * math.pi, 40, endpoint=False)
    parts.append(
        kit.tube(
            np.column_stack([0.17 * np.cos(around), 0.17 * np.sin(around), np.full(40, 0.17)]), 0.009, 10, closed=True
        )
    )
    return kit.joined(parts)


def add_props(wood, paper, metal) -> None:
    """Plinth, folding screen, lantern, and the drawing master's solids."""
    steps = [
        (0.001, 0),
        (0.98, 0),
        (1.0, 0.02),
        (1.0, 0.10),
        (0.98, 0.12),
        (0.74, 0.12),
        (0.72, 0.14),
        (0.72, 0.24),
        (0.70, 0.26),
        (0.001, 0.26),
    ]
    kit.add_object("Plinth", kit.turned(steps, 96), material=paper)
    panel = kit.new_mesh("Panel", make_screen_panel(0.72, 2.0))
    panel.materials.append(wood)
    hinge = Matrix.Translation((*kScreenPlace, 0)) @ Matrix.Rotation(math.radians(0), 4, "Z")
    for k, fold in enumerate((26, -52, 50)):
        hinge = hinge @ Matrix.Rotation(math.radians(fold), 4, "Z")
        kit.add_object(f"Panel {k}", panel, place=hinge)
        hinge = hinge @ Matrix.Translation((0.74, 0, 0))
    kit.add_object("Lantern", make_lantern(), material=metal, place=(1.62, 0.62, 0))
    kit.add_object("Stool", make_stool(), material=wood, place=(1.36, -0.78, 0))
    smooth = kit.new_mesh("Ball", kit.ball(10), smooth=True)
    ball = kit.add_object(
        "Ball", smooth, material=paper, place=Matrix.Translation((1.36, -0.78, 0.62)) @ Matrix.Scale(0.13, 4)
    )
    levels = ball.modifiers.new("Subdivision", "SUBSURF")
    levels.levels, levels.render_levels = 1, 2
    cone = kit.turned([(0.001, 0.0), (0.20, 0.0), (0.20, 0.012), (0.012, 0.50), (0.001, 0.506)], 64)
    kit.add_object("Cone", cone, material=paper, place=(-1.02, -1.18, 0))
    cube = Matrix.Translation((-0.52, -1.42, 0.13)) @ Matrix.Rotation(math.radians(24), 4, "Z")
    kit.add_object("Cube", kit.rounded_box((0.26, 0.26, 0.26), 0.012, 3), material=wood, place=cube)
    around = np.linspace(0, 2 * math.pi, 64, endpoint=False)
    hoop = kit.tube(
        np.column_stack([0.27 * np.cos(around), 0.27 * np.sin(around), np.zeros(64)]), 0.035, 20, closed=True
    )
    lean = Matrix.Translation((0.86, -1.22, 0.035))
    kit.add_object("Hoop", hoop, material=metal, place=lean)


def add_lights() -> None:
    kit.add_light(
        "AREA",
        "Softbox",
        (2.6, -3.4, 3.6),
        (0, 0, 1.0),
        190,
        color=(1.0, 0.95, 0.90),
        shape="RECTANGLE",
        size=0.9,
        size_y=0.6,
    )
    kit.add_light(
        "SPOT",
        "Spot",
        (-3.5, 2.5, 2.75),
        (0.1, -0.4, 0.45),
        900,
        color=(1.0, 0.80, 0.55),
        spot_size=math.radians(52),
        spot_blend=0.25,
        shadow_soft_size=0.04,
    )
    kit.add_light(
        "POINT", "Bulb", (1.62, 0.62, 1.02), (1.62, 0.62, 0), 46, color=(1.0, 0.62, 0.30), shadow_soft_size=0.015
    )
    kit.add_light("SUN", "Sun", (-4.2, -5.0, 5.4), (0, 0, 0), 0.85, color=(0.66, 0.78, 1.0), angle=math.radians(0.526))


def build(options: argparse.Namespace) -> None:
    paper = kit.new_material("Paper", (0.66, 0.64, 0.60))
    wood = kit.new_material("Wood", (0.52, 0.31, 0.14), 0.5)
    pine = kit.new_material("Pine", (0.74, 0.52, 0.28), 0.45)
    metal = kit.new_material("Brass", (0.55, 0.38, 0.14), 0.4)
    kit.add_object(
        "Backdrop",
        kit.new_mesh("Backdrop", make_backdrop(), smooth=True),
        material=kit.new_material("Backdrop", (0.56, 0.55, 0.53)),
    )
    add_props(wood, paper, metal)
    mannequin.add_mannequin(Matrix.Translation((0, 0, 0.26)) @ Matrix.Rotation(math.radians(28), 4, "Z"), pine)
    add_lights()
    kit.add_camera((0.75, -6.3, 1.75), (-0.12, 0.0, 0.98), lens_mm=43)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__)
