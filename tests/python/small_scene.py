# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A ground plane, a box above it, a sun straight down: the smallest scene with a shadow."""

import numpy as np

GROUND = np.array([[-4, 0, -4], [4, 0, -4], [4, 0, 4], [-4, 0, 4]], dtype=np.float32)
GROUND_TRIANGLES = np.array([[0, 2, 1], [0, 3, 2]], dtype=np.uint32)
BOX = np.array([[x, y, z] for x in (-1, 1) for y in (1, 2) for z in (-1, 1)], dtype=np.float32)
BOX_TRIANGLES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ],
    dtype=np.uint32,
)


def looking_down(height):
    """A rigid frame at (0, height, 0) whose -Z points along -Y."""
    return np.array([[1, 0, 0, 0], [0, 0, 1, height], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=np.float64)


def make_scene(core, lights=1):
    scene = core.Scene()
    scene.add_mesh("ground", GROUND.copy(), GROUND_TRIANGLES.copy())
    scene.add_mesh("box", BOX.copy(), BOX_TRIANGLES.copy())
    flags = core.INSTANCE_CAMERA | core.INSTANCE_SHADOW
    # The box casts but is not seen, so that the camera above sees its shadow.
    scene.set_instances(
        np.array([0, 1], dtype=np.uint32),
        np.stack([np.eye(4), np.eye(4)]),
        np.array([flags, core.INSTANCE_SHADOW], dtype=np.uint32),
    )
    for index in range(lights):
        scene.add_light(f"sun {index}", "SUN", looking_down(5.0))
    return scene


def make_camera(core, half_width=4.0):
    return core.Camera(
        perspective=False,
        window=(-half_width, half_width, -half_width, half_width),
        clip_start=0.1,
        clip_end=100.0,
        world_from_camera=looking_down(10.0),
    )
