# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""model: any Wavefront OBJ file on a plane, in one light."""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
import scene_kit as kit
from mathutils import Matrix

kSizeM = 2.0  # largest extent of the model once placed


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--obj", required=True, type=Path, help="the model; only its vertices and faces are read")
    parser.add_argument(
        "--light", choices=["spot", "sun", "point", "area"], default="spot", help="kind of the one light"
    )
    parser.add_argument("--up", choices=["y", "z"], default="y", help="axis of the file that points up (default: y)")
    parser.add_argument("--hide-model", action="store_true", help="the camera sees only the plane and the shadow on it")
    parser.add_argument("--turn", type=float, default=0.0, help="degrees about the vertical axis")


def read_obj(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) float32 and triangles (m, 3) int32 of a Wavefront OBJ file; polygons become fans.

    Blender's own importers differ between versions and are slow on big files. Raises ValueError naming the file.
    """
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    vertex_text = [line[2:] for line in lines if line.startswith("v ")]
    face_text = [line[2:] for line in lines if line.startswith("f ")]
    if not vertex_text or not face_text:
        raise ValueError(f"{path} holds {len(vertex_text)} vertices and {len(face_text)} faces: nothing to show")
    width = len(vertex_text[0].split())
    positions = np.array(" ".join(vertex_text).split(), dtype=np.float32).reshape(len(vertex_text), width)[:, :3]
    faces = [[token.split("/", 1)[0] for token in text.split()] for text in face_text]
    triangles = np.array(
        [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)], dtype=np.int64
    )
    if (triangles < 0).any():
        raise ValueError(f"{path} counts its vertices backwards (negative indices), which this reader does not follow")
    if triangles.max() > len(positions) or triangles.min() < 1:
        raise ValueError(f"{path} names vertex {triangles.max()}, but holds {len(positions)}")
    return positions, (triangles - 1).astype(np.int32)


def place_on_ground(positions: np.ndarray, up: str, turn_deg: float) -> np.ndarray:
    """Z up, largest extent kSizeM, standing on z = 0, centred."""
    if up == "y":
        positions = positions[:, [0, 2, 1]] * np.array([1, -1, 1], dtype=np.float32)
    turn = np.array(Matrix.Rotation(math.radians(turn_deg), 3, "Z"))
    positions = positions @ turn.T
    low, high = positions.min(axis=0), positions.max(axis=0)
    centre = (low + high) / 2
    return (positions - [centre[0], centre[1], low[2]]) * (kSizeM / (high - low).max())


def build(options: argparse.Namespace) -> None:
    positions, triangles = read_obj(options.obj)
    shape = kit.Shape(place_on_ground(positions, options.up, options.turn), triangles)
    mesh = kit.new_mesh(options.obj.stem, shape)
    model = kit.add_object(options.obj.stem, mesh, material=kit.new_material("Clay", (0.70, 0.42, 0.26)))
    model.visible_camera = not options.hide_model
    half = 40.0
    plane = kit.Shape([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], [[0, 1, 2, 3]])
    kit.add_object("Plane", plane, material=kit.new_material("Plaster", (0.70, 0.69, 0.66)))
    settings = {
        "spot": {"spot_size": math.radians(50), "spot_blend": 0.3, "shadow_soft_size": 0.06},
        "sun": {"angle": math.radians(0.526)},
        "point": {"shadow_soft_size": 0.06},
        "area": {"shape": "SQUARE", "size": 0.5},
    }[options.light]
    energy = 3.0 if options.light == "sun" else 1100.0
    target = (0.3, 0.2, float(shape.positions[:, 2].max()) * 0.4)
    kit.add_light(options.light.upper(), "Key", (-2.7, -2.8, 4.8), target, energy, color=(1.0, 0.94, 0.84), **settings)
    kit.add_camera((3.0, -5.0, 3.1), target, lens_mm=44)


if __name__ in ("__main__", "<run_path>"):
    kit.main(build, __doc__, add_options)
