# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiny moves of lights or of the camera, the same each time, put back afterwards.

A move goes sideways as seen from the middle of what is looked at: by an angle each step, so that it means the same in
small and in large scenes. An object follows an empty by a constraint at the end of its own, so animation, parents and
constraints keep their say about where the move begins.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
from mathutils import Matrix, Vector

from .scene_guard import SceneGuard

# The move's direction, from level to upwards: along neither axis of picture or map.
SLANT_DEG = 30.0
# Nearest that a light is taken to be, in distances from the camera: one in the middle has no side to go to.
NEAREST_PART = 1e-3


class MoveError(RuntimeError):
    """An object can't be moved; the text names it and the remedy."""


def compute_move(matrix_ws: Matrix, pivot_ws: Vector, angle: float, *, turns: bool, farthest: float) -> Matrix:
    """The place of an object after its move by `angle` (radians) about the pivot: shifted, or turned on its spot where
    only its direction matters (`turns`, suns). `farthest`: a distance that is large in this scene."""
    place = matrix_ws.to_translation()
    away = matrix_ws.to_quaternion() @ Vector((0, 0, 1)) if turns else place - pivot_ws
    distance = max(away.length, NEAREST_PART * farthest)
    away = away.normalized() if away.length > 0 else Vector((0, 0, 1))
    helper = Vector((0, 0, 1)) if abs(away.z) < 0.9 else Vector((1, 0, 0))
    level = helper.cross(away).normalized()
    slant = math.radians(SLANT_DEG)
    sideways = math.cos(slant) * level + math.sin(slant) * away.cross(level)
    if turns:
        spot = Matrix.Translation(place)
        return spot @ Matrix.Rotation(angle, 4, away.cross(sideways)) @ spot.inverted_safe() @ matrix_ws
    return Matrix.Translation(distance * math.tan(angle) * sideways) @ matrix_ws


class Mover:
    """Moves objects of a scene within a `with` block.

        with Mover(scene, view_layer, [light_object], pivot_ws) as mover:
            mover.move(math.radians(0.1))
            ... render ...

    The scene must be at its frame, which may not change meanwhile. Raises MoveError.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        things: Sequence[bpy.types.Object],
        pivot_ws: Sequence[float],
    ) -> None:
        self._scene, self._view_layer = scene, view_layer
        self._things = list(things)
        self._pivot_ws = Vector(pivot_ws)
        self._guard = SceneGuard()
        self._handles: list[tuple[bpy.types.Object, Matrix, bool]] = []

    def __enter__(self) -> Mover:
        graph = self._view_layer.depsgraph
        starts = [thing.evaluated_get(graph).matrix_world.copy() for thing in self._things]
        camera = self._scene.camera.evaluated_get(graph).matrix_world.to_translation()
        self._farthest = (camera - self._pivot_ws).length
        self._guard.on_exit(self._view_layer.update)
        try:
            for thing, start in zip(self._things, starts, strict=True):
                self._attach(thing, start)
        except BaseException:
            self._guard.__exit__(RuntimeError)
            raise
        return self

    def __exit__(self, *error: object) -> None:
        self._guard.__exit__(error[0])

    def _attach(self, thing: bpy.types.Object, start: Matrix) -> None:
        handle = self._guard.made(bpy.data.objects, bpy.data.objects.new(f"{thing.name} moved", None))
        self._scene.collection.objects.link(handle)
        handle.matrix_world = start
        try:
            constraint = thing.constraints.new("COPY_TRANSFORMS")
        except RuntimeError as error:
            raise MoveError(
                f'"{thing.name}" can not be moved: {str(error).strip()}; make it local, or choose others with --lights'
            ) from error
        self._guard.on_exit(lambda: thing.constraints.remove(constraint))
        constraint.target = handle
        turns = thing.type == "LIGHT" and thing.data.type == "SUN"
        self._handles.append((handle, start, turns))

    def move(self, angle: float) -> None:
        """Puts all objects where the move has brought them at `angle` radians; 0: where they were."""
        for handle, start, turns in self._handles:
            handle.matrix_world = compute_move(start, self._pivot_ws, angle, turns=turns, farthest=self._farthest)
        self._view_layer.update()
