# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lights as LightData, and the names that their layers go by."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import bpy
import numpy as np

from .camera_export import without_scale
from .snapshot import LightData

_SCALE_ROUNDING = 1e-6
_LEAST_SPOT_SCALE = 1e-6  # as the core takes it


def is_portal(light: Any) -> bool:
    """Whether an area light only guides the sky's light (Cycles); such a light is no light of its own."""
    return light.type == "AREA" and bool(getattr(getattr(light, "cycles", None), "is_portal", False))


def casts_shadow(light: Any) -> bool:
    """The light's shadow switch. Before 4.2 there are two, EEVEE's and Cycles', and both must be on."""
    return bool(light.use_shadow) and bool(getattr(getattr(light, "cycles", None), "cast_shadow", True))


def light_color(light: Any) -> tuple[tuple[float, float, float], float]:
    """(linear RGB, energy), with temperature and exposure (4.5+) applied."""
    color = np.array(light.color[:], np.float64)
    if getattr(light, "use_temperature", False):
        color = color * np.array(light.temperature_color[:], np.float64)
    energy = float(light.energy) * 2.0 ** getattr(light, "exposure", 0.0)
    return (float(color[0]), float(color[1]), float(color[2])), energy


def light_template(light: Any, name: str) -> LightData:
    """All of a light but its place and its linking; `area_size` is still without the object's scale."""
    color, energy = light_color(light)
    data = LightData(name, light.type, np.eye(4), color=color, energy=energy, casts_shadow=casts_shadow(light))
    if light.type in {"POINT", "SPOT"}:
        data.radius = float(light.shadow_soft_size)
    if light.type == "SPOT":
        data.spot_angle, data.spot_blend = float(light.spot_size), float(light.spot_blend)
    elif light.type == "SUN":
        data.sun_angle = float(light.angle)
    elif light.type == "AREA":
        two_sizes = light.shape in {"RECTANGLE", "ELLIPSE"}
        data.area_size = (float(light.size), float(light.size_y if two_sizes else light.size))
        data.area_round = light.shape in {"DISK", "ELLIPSE"}
    return data


def find_spot_scale(world_from_object: np.ndarray) -> tuple[float, float]:
    """A spot's cone follows its object's scale, of which only the ratios to that along z count: the cone's width along
    x and y, of the round one's. Cycles has done so since 4.0."""
    if bpy.app.version < (4, 0, 0):
        return 1.0, 1.0
    x, y, z = np.linalg.norm(np.asarray(world_from_object, np.float64)[:3, :3], axis=0)
    if not z > 0:
        return 1.0, 1.0
    ratios = [float(side / z) for side in (x, y)]
    # Matrices are float32: what differs by their rounding is round.
    return tuple(
        1.0 if abs(ratio - 1.0) < _SCALE_ROUNDING else min(max(ratio, _LEAST_SPOT_SCALE), 1.0 / _LEAST_SPOT_SCALE)
        for ratio in ratios
    )


def placed(template: LightData, name: str, world_from_object: np.ndarray) -> LightData:
    """The light at its place: axes without scale, which goes into the area's size."""
    scale = np.linalg.norm(np.asarray(world_from_object, np.float64)[:3, :2], axis=0)
    spot_scale = find_spot_scale(world_from_object) if template.kind == "SPOT" else template.spot_scale
    size = (template.area_size[0] * float(scale[0]), template.area_size[1] * float(scale[1]))
    return replace(
        template,
        name=name,
        world_from_light=without_scale(world_from_object),
        spot_scale=spot_scale,
        area_size=size if template.kind == "AREA" else template.area_size,
    )


def object_name(item: Any) -> str:
    """An object's name, with its library's if it is linked: linked and local objects may share a name."""
    original = item.original
    return original.name if original.library is None else original.name_full


class LightNamer:
    """Names of lights: the object's own, and for instanced ones also the instancer's, numbered from the second on."""

    def __init__(self) -> None:
        self._count: Counter[tuple[str, str]] = Counter()

    def name(self, light_object: str, instancer: str | None) -> str:
        if instancer is None:
            return light_object
        self._count[light_object, instancer] += 1
        number = self._count[light_object, instancer]
        return f"{light_object} @{instancer}" + (f" {number}" if number > 1 else "")
