# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Registers the add-on's parts in order, and takes them down again in the reverse one."""

from __future__ import annotations

import atexit

import bpy

from . import bridge, engine, preferences, properties, ui

_PARTS = (properties, preferences, engine, ui)
_registered: list = []


def register() -> None:
    """Registers all parts, or none: a failure takes down what was up."""
    try:
        for part in _PARTS:
            part.register()
            _registered.append(part)
    except BaseException:
        unregister()
        raise
    if not bpy.app.binary_path:
        # As a module, Blender 4.5 hangs at exit while a Python engine is registered. (The application has taken its
        # types down by itself when Python gets to this.)
        atexit.register(unregister)


def unregister() -> None:
    """Takes down what is registered and closes the native session. Harmless when called again."""
    atexit.unregister(unregister)
    while _registered:
        _registered.pop().unregister()
    bridge.shutdown()
