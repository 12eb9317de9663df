# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels, made from the technique descriptors, and Blender's own panels that make sense with this engine."""

from __future__ import annotations

from typing import Any, ClassVar

import bpy

from . import bridge, jobs, properties
from .preferences import wrapped

ENGINE_ID = "SHADOW_LAYERS"
# Blender's panels made for any engine, less those that do nothing here. Panels of the node editor share their engine
# set with the one in the Properties they were made from, so both names stand here.
_EXCLUDED_PANELS = {
    "DATA_PT_light",
    "DATA_PT_area",
    "DATA_PT_spot",
    "DATA_PT_falloff_curve",
    "DATA_PT_preview",
    "NODE_DATA_PT_light",
    "NODE_DATA_PT_area",
    "NODE_DATA_PT_spot",
    "VIEWLAYER_PT_filter",
    "VIEWLAYER_PT_layer_passes",
    "MATERIAL_PT_freestyle_line",
}
_EXCLUDED_PREFIXES = ("RENDER_PT_simplify", "RENDER_PT_freestyle", "RENDER_PT_stereoscopy", "VIEWLAYER_PT_freestyle")
_PASSES_SHOWN = 40


class _EnginePanel:
    """Shown with this engine only."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES: ClassVar[set[str]] = {ENGINE_ID}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Called by Blender."""
        return context.engine in cls.COMPAT_ENGINES


def _draw_parameters(layout: Any, owner: Any, info: dict[str, Any]) -> None:
    own = properties.own_parameters(info)
    group = getattr(owner, info["id"], None)
    for parameter in own:
        unit = f" ({parameter['unit']})" if parameter["unit"] else ""
        layout.prop(group, parameter["id"], text=parameter["label"] + unit)


def _draw_shared(layout: Any, owner: Any, used_by: list[dict[str, Any]]) -> None:
    used = {parameter["id"] for info in used_by for parameter in info["parameters"] if parameter["shared"]}
    for parameter in properties.shared_parameters():
        if parameter["id"] in used:
            unit = f" ({parameter['unit']})" if parameter["unit"] else ""
            layout.prop(owner, parameter["id"], text=parameter["label"] + unit)


def _draw_problem(layout: Any, text: str) -> None:
    column = layout.box().column(align=True)
    for number, line in enumerate(wrapped(text, 56)):
        column.label(text=line, icon="BLANK1" if number else "ERROR")


class SHADOWLAYERS_PT_render(_EnginePanel, bpy.types.Panel):
    """Techniques and what they share."""

    bl_label = "Shadow Layers"
    bl_context = "render"

    def draw(self, context: bpy.types.Context) -> None:
        """Called by Blender."""
        layout, settings = self.layout, context.scene.shadow_layers
        layout.use_property_split = True
        layout.use_property_decorate = False
        problem = bridge.available()
        if problem is not None:
            _draw_problem(layout, problem)
            return
        column = layout.column(heading="Techniques")
        for info in properties.technique_infos():
            column.prop(settings, "use_" + info["id"], text=info["label"])
        chosen = properties.chosen_techniques(context.scene)
        _draw_shared(layout.column(), settings, chosen)
        layout.prop(settings, "samples")
        cycles = getattr(context.scene, "cycles", None)
        if settings.samples > 1 and cycles is not None:
            layout.prop(cycles, "pixel_filter_type", text="Pixel Filter")
            if cycles.pixel_filter_type != "BOX":
                layout.prop(cycles, "filter_width", text="Width (px)")
        if not chosen:
            layout.label(text="No technique is chosen", icon="INFO")


class SHADOWLAYERS_PT_performance(_EnginePanel, bpy.types.Panel):
    """Back end and threads."""

    bl_label = "Performance"
    bl_context = "render"
    bl_parent_id = "SHADOWLAYERS_PT_render"
    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Called by Blender."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(context.scene.shadow_layers, "backend")
        layout.prop(context.scene.shadow_layers, "threads")


class SHADOWLAYERS_PT_light(_EnginePanel, bpy.types.Panel):
    """The light itself, its shadow switch and its own settings."""

    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Called by Blender."""
        return context.light is not None and super().poll(context)

    def draw(self, context: bpy.types.Context) -> None:
        """Called by Blender."""
        layout, light = self.layout, context.light
        layout.row().prop(light, "type", expand=True)
        layout.use_property_split = True
        layout.prop(light, "color")
        layout.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        if light.type == "SPOT":
            layout.prop(light, "spot_size", text="Cone Angle")
            layout.prop(light, "spot_blend", text="Blend")
        elif light.type == "AREA":
            layout.prop(light, "shape")
            layout.prop(light, "size")
            if light.shape in {"RECTANGLE", "ELLIPSE"}:
                layout.prop(light, "size_y", text="Size Y")
        layout.prop(light, "use_shadow", text="Casts Shadow")
        cycles = getattr(light, "cycles", None)
        if hasattr(cycles, "cast_shadow"):
            layout.prop(cycles, "cast_shadow", text="Casts Shadow (Cycles)")


class SHADOWLAYERS_PT_light_layers(_EnginePanel, bpy.types.Panel):
    """What is rendered for the light."""

    bl_label = "Shadow Layers"
    bl_context = "data"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Called by Blender."""
        return context.light is not None and super().poll(context)

    def draw(self, context: bpy.types.Context) -> None:
        """Called by Blender."""
        layout, own = self.layout, context.light.shadow_layers
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(own, "mode", text="Layers")
        if own.mode != "OVERRIDE" or bridge.available() is not None:
            return
        layout.prop(own, "technique")
        if not own.technique:
            return
        info = bridge.find_technique(own.technique)
        _draw_shared(layout.column(), own, [info])
        _draw_parameters(layout.column(), own, info)


class SHADOWLAYERS_PT_passes(_EnginePanel, bpy.types.Panel):
    """The passes that a render will have."""

    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: bpy.types.Context) -> None:
        """Called by Blender."""
        layout, view_layer = self.layout, context.view_layer
        layout.use_property_split = True
        layout.prop(view_layer.shadow_layers, "enabled")
        column = layout.column(align=True)
        column.label(text="Combined")
        column.label(text="Coverage")
        if bridge.available() is not None:
            return
        lights = jobs.predicted_lights(context.scene, view_layer)
        try:
            planned = jobs.plan_passes(
                [light.name for light in lights], jobs.jobs_for(context.scene, view_layer, lights)
            )
        except bridge.ShadowLayersError as error:
            _draw_problem(layout, str(error))
            return
        for item in planned[:_PASSES_SHOWN]:
            column.label(text=item.name, icon="LIGHT")
        if len(planned) > _PASSES_SHOWN:
            column.label(text=f"and {len(planned) - _PASSES_SHOWN} more")


class SHADOWLAYERS_PT_ray_visibility(_EnginePanel, bpy.types.Panel):
    """Who sees the object: the camera (it receives) and the lights (it casts)."""

    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Called by Blender."""
        return context.object is not None and super().poll(context)

    def draw(self, context: bpy.types.Context) -> None:
        """Called by Blender."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop(context.object, "visible_camera", text="Camera")
        layout.prop(context.object, "visible_shadow", text="Shadow")


_PANELS = [
    SHADOWLAYERS_PT_render,
    SHADOWLAYERS_PT_performance,
    SHADOWLAYERS_PT_light,
    SHADOWLAYERS_PT_light_layers,
    SHADOWLAYERS_PT_passes,
    SHADOWLAYERS_PT_ray_visibility,
]
_registered: list[type] = []


def _technique_panel(info: dict[str, Any]) -> type:
    """A sub-panel for the parameters of one technique, with its limits."""

    def poll(_cls: type, context: bpy.types.Context) -> bool:
        return context.engine == ENGINE_ID and getattr(context.scene.shadow_layers, "use_" + info["id"])

    def draw(self: Any, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        _draw_parameters(layout.column(), context.scene.shadow_layers, info)
        column = layout.column(align=True)
        for sentence in (info["limits"], *info["restrictions"]):
            for number, line in enumerate(wrapped(sentence, 56)):
                column.label(text=line, icon="BLANK1" if number else "INFO")

    body = {
        "__doc__": f"Parameters of {info['label']}",
        "bl_label": info["label"],
        "bl_space_type": "PROPERTIES",
        "bl_region_type": "WINDOW",
        "bl_context": "render",
        "bl_parent_id": "SHADOWLAYERS_PT_render",
        "COMPAT_ENGINES": {ENGINE_ID},
        "poll": classmethod(poll),
        "draw": draw,
    }
    return type(f"SHADOWLAYERS_PT_technique_{info['id']}", (bpy.types.Panel,), body)


def _compatible_panels() -> list[type]:
    """Blender's panels that are made for every engine, less those that do nothing here."""
    return [
        panel
        for panel in bpy.types.Panel.__subclasses__()
        if "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ())
        and panel.__name__ not in _EXCLUDED_PANELS
        and not panel.__name__.startswith(_EXCLUDED_PREFIXES)
    ]


def register() -> None:
    techniques = [_technique_panel(info) for info in properties.technique_infos() if properties.own_parameters(info)]
    for panel in [*_PANELS[:1], *techniques, *_PANELS[1:]]:
        bpy.utils.register_class(panel)
        _registered.append(panel)
    for panel in _compatible_panels():
        panel.COMPAT_ENGINES.add(ENGINE_ID)


def unregister() -> None:
    for panel in bpy.types.Panel.__subclasses__():
        if panel not in _registered and ENGINE_ID in getattr(panel, "COMPAT_ENGINES", ()):
            panel.COMPAT_ENGINES.discard(ENGINE_ID)
    while _registered:
        bpy.utils.unregister_class(_registered.pop())
