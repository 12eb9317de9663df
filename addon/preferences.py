# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences of the add-on, and what holds when there are none (`--addons`, the bpy module, tests)."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from . import bridge
from .properties import backend_items


class ShadowLayersPreferences(bpy.types.AddonPreferences):
    """Settings of the whole process: the core's session is made with them."""

    bl_idname = __package__

    backend: bpy.props.EnumProperty(
        name="Back End", description="Where the core draws its maps", items=backend_items(), default="auto"
    )
    threads: bpy.props.IntProperty(
        name="Threads", description="CPU threads of the core; 0 takes all cores", default=0, min=0, max=256
    )

    def draw(self, _context: bpy.types.Context) -> None:
        """Called by Blender."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "backend")
        layout.prop(self, "threads")
        problem = bridge.available()
        if problem is None:
            info = bridge.session_info()
            renderer = info.get("gl_renderer", "not started yet")
            layout.label(text=f"Core {info['version']} ({info['revision']}), {renderer}")
        else:
            for number, line in enumerate(wrapped(problem)):
                layout.label(text=line, icon="BLANK1" if number else "ERROR")


@dataclass(frozen=True)
class SessionSettings:
    """What bridge.session() is called with."""

    backend: str = "auto"
    threads: int = 0


def wrapped(text: str, width: int = 90) -> list[str]:
    """Lines of a text, for labels, which don't wrap."""
    import textwrap

    return textwrap.wrap(text, width)


def session_settings(scene: bpy.types.Scene) -> SessionSettings:
    """The scene's back end and threads, else the preferences', else the defaults."""
    addon = bpy.context.preferences.addons.get(__package__) if bpy.context.preferences else None
    stored = getattr(addon, "preferences", None)
    settings = scene.shadow_layers
    backend, threads = settings.backend, settings.threads
    if backend == "PREFERENCES":
        backend = getattr(stored, "backend", "auto")
    return SessionSettings(backend, threads or getattr(stored, "threads", 0))


def register() -> None:
    bpy.utils.register_class(ShadowLayersPreferences)


def unregister() -> None:
    bpy.utils.unregister_class(ShadowLayersPreferences)
