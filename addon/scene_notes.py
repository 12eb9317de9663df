# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles shows and the layers don't follow, of lights and objects that are exported: (warning, name) pairs.

A light without size has the same shadow whatever its nodes, its cone's soft rim or its falloff do: they change how much
light there is, not the part of it that arrives. Of a light with a size they weigh its points, and so change the part.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from . import bridge
from .jobs import SceneLight
from .materials import is_even_light
from .snapshot import Job

Note = tuple[str, str]
_SPREAD_ROUNDING = 1e-4


def has_size(light: Any) -> bool:
    """Whether Cycles gives the light (Blender's data) soft shadows."""
    if light.type == "AREA":
        return True
    return (light.angle if light.type == "SUN" else light.shadow_soft_size) > 0


def find_light_notes(lights: Sequence[SceneLight], jobs: Sequence[Job]) -> Iterator[Note]:
    """Of lights whose layers follow their size."""
    for index in sorted({job.light for job in jobs if _follows_size(job)}):
        name, data = lights[index].name, lights[index].data
        if has_size(data):
            yield from ((text, name) for text in _find_uneven(data))


def _follows_size(job: Job) -> bool:
    return bridge.get_truth(job.technique, job.parameters)["kind"] == "soft"


def _find_uneven(light: Any) -> Iterator[str]:
    if not is_even_light(light):
        yield "nodes and textures of lights with a size are not followed: their light is taken as even"
    if light.type == "AREA" and getattr(light, "spread", math.pi) < math.pi - _SPREAD_ROUNDING:
        yield "spread of area lights is not followed: they shine alike in all directions"
    if light.type == "SPOT" and light.spot_blend > 0:
        yield "blend of spot lights with a size is not followed where the cone's soft rim lies in a shadow's edge"


def find_object_notes(scene: Any, item: Any) -> Iterator[Note]:
    """Of an evaluated object that is exported; `scene` is the evaluated scene."""
    if uses_adaptive_subdivision(scene, item):
        yield "adaptive subdivision is not followed: the modifier's render level is taken", item.name
    if _may_be_culled(scene, item):
        yield "culling by Simplify is not followed: Cycles may leave these objects out", item.name


def uses_adaptive_subdivision(scene: Any, item: Any) -> bool:
    """Whether Cycles dices the object by what is seen of it."""
    last = item.modifiers[-1] if len(item.modifiers) else None
    if last is None or last.type != "SUBSURF" or not last.show_render:
        return False
    if hasattr(last, "use_adaptive_subdivision"):  # 5.0 on
        return bool(last.use_adaptive_subdivision)
    experimental = getattr(scene.cycles, "feature_set", "SUPPORTED") == "EXPERIMENTAL"
    return experimental and bool(getattr(item.cycles, "use_adaptive_subdivision", False))


def _may_be_culled(scene: Any, item: Any) -> bool:
    if not scene.render.use_simplify or not hasattr(scene, "cycles"):
        return False
    kinds = ("use_camera_cull", "use_distance_cull")
    return any(getattr(scene.cycles, kind, False) and getattr(item.cycles, kind, False) for kind in kinds)
