# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine SHADOW_LAYERS. Its methods forward to `final_render` (F12) and `viewport`.

To take what is rendered as arrays, with times, settings and auxiliary pictures, use `capture` (see capture.py):

    with engine.capture(aux=("position", "normal", "ids")) as captured:
        bpy.ops.render.render()
"""

from __future__ import annotations

from typing import Any

import bpy

from . import final_render, passes, viewport
from .capture import capture

__all__ = ["ENGINE_ID", "ShadowLayersEngine", "capture", "register", "unregister"]

ENGINE_ID = "SHADOW_LAYERS"


class ShadowLayersEngine(bpy.types.RenderEngine):
    """Renders every light's shadow as a pass of its own, and a clay picture as Combined."""

    bl_idname = ENGINE_ID
    bl_label = "Shadow Layers"
    bl_use_preview = False
    bl_use_postprocess = True  # else Blender skips the compositor
    bl_use_shading_nodes_custom = False  # Cycles' and EEVEE's material nodes stay editable
    bl_use_eevee_viewport = True  # Material Preview
    bl_use_custom_freestyle = True  # else Freestyle goes to EEVEE
    bl_use_gpu_context = False  # the core has its own context on its own thread

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._job: final_render.FinalRender | None = None
        self._view: viewport.Viewport | None = None

    def __del__(self) -> None:
        # Blender may free the struct before the Python object: then nothing of it can be read any more.
        try:
            view = self._view
        except (AttributeError, ReferenceError):
            return
        if view is not None:
            view.close()

    def update_render_passes(self, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> None:
        """Called by Blender for the result and for the compositor's sockets."""
        passes.announce(self, scene, view_layer)

    def update(self, data: bpy.types.BlendData, depsgraph: bpy.types.Depsgraph) -> None:
        """Called by Blender with its data locked: copies the scene out."""
        self._job = final_render.FinalRender(self, depsgraph)

    def render(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Called by Blender without the lock, once per view layer."""
        job, self._job = self._job, None
        job.run()

    def view_update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Called by Blender when the scene changed."""
        if self._view is None:
            self._view = viewport.Viewport(self)
        self._view.sync(context, depsgraph)

    def view_draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Called by Blender when the viewport is drawn."""
        if self._view is None:
            self._view = viewport.Viewport(self)
        self._view.draw(context, depsgraph)


def register() -> None:
    bpy.utils.register_class(ShadowLayersEngine)


def unregister() -> None:
    viewport.close_all()
    bpy.utils.unregister_class(ShadowLayersEngine)
    final_render.forget()
