# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow Layers: the shadows of every light as image layers. Imports nothing of Blender until register() is called, so
that snapshot, names and compare can be used without it."""

bl_info = {
    "name": "Shadow Layers",
    "author": "Shadow Layers contributors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render Engine",
    "description": "Shadows of every light as image layers, measured against Cycles",
    "category": "Render",
}


def register() -> None:
    """Called by Blender when the add-on is enabled. Works without the native module; rendering then says what to do."""
    from . import registration

    registration.register()


def unregister() -> None:
    """Called by Blender when the add-on is disabled; also closes the native session."""
    from . import registration

    registration.unregister()
