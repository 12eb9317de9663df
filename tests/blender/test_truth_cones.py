# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Spot lights with uneven scale: the layers' cones against those that Cycles shows, pixel by pixel."""

import bpy
import numpy as np
import pytest
from addon_helpers import add_camera, add_light, add_object, cube_mesh, plane_mesh, render

WIDTH, HEIGHT = 160, 120


@pytest.fixture
def scene(fresh_scene):
    fresh_scene.render.resolution_x, fresh_scene.render.resolution_y = WIDTH, HEIGHT
    fresh_scene.shadow_layers.samples = 1  # at the pixel's centre, as the truth
    add_object("Ground", plane_mesh(40))
    cube = add_object("Cube", cube_mesh(0.6), (0.4, 0.3, 0.8))
    cube.rotation_euler = (0.3, 0.2, 0.5)
    cube.visible_camera = False  # so that all that is seen is turned to the lamp
    add_camera((0, 0, 12))
    return fresh_scene


def cycles_reach(module, scene) -> tuple[np.ndarray, np.ndarray]:
    """The pixels that the lamp reaches if nothing casts shadows, and those that it reaches."""
    with module("truth").CyclesTruth(scene, bpy.context.view_layer, WIDTH, HEIGHT) as truth:
        found = truth.render_light("Spot")
    return found.lit, found.visible & found.lit


@pytest.mark.parametrize("scale", [(1, 2, 1), (3, 1, 0.5), (-0.4, 1.3, 1)])
@pytest.mark.parametrize("technique", ["exact", "sm", "soft", "fsasm"])
def test_cone_is_that_of_cycles(scene, module, scale, technique):
    lamp = add_light("SPOT", location=(1, 0.5, 5), spot_size=0.7, spot_blend=0.0, energy=1e4, shadow_soft_size=0.0)
    lamp.rotation_euler, lamp.scale = (0.15, -0.1, 0.4), scale
    scene.shadow_layers.techniques = {technique}
    scene.shadow_layers.map_size = 512
    frame = render().frames[0]
    lit, visible = cycles_reach(module, scene)
    assert 300 < lit.sum() < 0.9 * lit.size
    layer = frame.layers[0].channels["visibility"]
    # Outside of the cone a layer is 1; inside it is what Cycles finds.
    bad = (layer < 0.5) != (lit & ~visible)
    allowed = {"sm": 60, "fsasm": 12}.get(technique, 1)
    assert bad.sum() <= allowed, int(bad.sum())
    combined = frame.combined[..., :3].max(axis=2)
    differs = (combined > 2 * combined[~lit].mean()) != visible
    if technique != "fsasm":  # which shows a part of each pixel
        assert differs.sum() <= max(allowed, 3), int(differs.sum())


def test_cubes_shadow_shows_where_a_round_cone_would_not_reach(scene, module):
    """A cone made wider: without the scale the cube would stand outside of it."""
    lamp = add_light("SPOT", location=(0, 2.5, 5), spot_size=0.5, spot_blend=0.0, energy=1e4, shadow_soft_size=0.0)
    lamp.scale = (1, 3, 1)
    scene.shadow_layers.techniques = {"exact"}
    layer = render().frames[0].layers[0].channels["visibility"]
    lit, visible = cycles_reach(module, scene)
    assert ((layer < 0.5) == (lit & ~visible)).all()
    assert (layer < 0.5).any() == (bpy.app.version >= (4, 0))
