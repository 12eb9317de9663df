# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch's options put into the opened file, which is never saved: scene, camera, techniques, parameters, lights."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Iterable
from typing import Any

import bpy

from . import bridge, jobs, properties
from .batch_files import BatchError, Progress
from .engine import ENGINE_ID
from .light_export import object_name

TRUE_WORDS = {"1", "true", "yes", "on"}
FALSE_WORDS = {"0", "false", "no", "off"}


def list_names(names: Iterable[str]) -> str:
    """For a message: what there is to choose from."""
    names = list(names)
    shown = ", ".join(f'"{name}"' for name in names[:20]) or "none"
    return shown + (f" and {len(names) - 20} more" if len(names) > 20 else "")


def register_addon() -> None:
    """Registers this copy of the add-on, in place of another that Blender may have enabled."""
    package = __package__
    for engine in list(bpy.types.RenderEngine.__subclasses__()):
        if getattr(engine, "bl_idname", "") != ENGINE_ID or not engine.is_registered:
            continue
        owner = engine.__module__.rpartition(".")[0]
        if owner == package:
            return
        sys.modules[owner].unregister()
    importlib.import_module(package).register()


def open_file(options: argparse.Namespace) -> None:
    """Opens the file of the command line; inside Blender, its own command line may have done so."""
    if options.file is None:
        if not bpy.data.filepath:
            raise BatchError("no file is open: name a .blend file before the verb")
        return
    if not options.file.is_file():
        raise BatchError(f'there is no file "{options.file}": check its name')
    try:
        bpy.ops.wm.open_mainfile(filepath=str(options.file.resolve()), load_ui=False)
    except RuntimeError as error:
        raise BatchError(f'"{options.file}" can not be opened: {str(error).strip()}') from error


def choose_scene(options: argparse.Namespace) -> bpy.types.Scene:
    if options.scene is None:
        return bpy.context.scene
    scene = bpy.data.scenes.get(options.scene)
    if scene is None:
        raise BatchError(
            f'there is no scene "{options.scene}"; the file has {list_names(s.name for s in bpy.data.scenes)}'
        )
    if bpy.context.window is not None:
        bpy.context.window.scene = scene
    return scene


def choose_view_layers(scene: bpy.types.Scene, options: argparse.Namespace) -> list[bpy.types.ViewLayer]:
    """Those that will be rendered; the others are switched off."""
    if options.view_layer is not None:
        layer = scene.view_layers.get(options.view_layer)
        if layer is None:
            names = list_names(layer.name for layer in scene.view_layers)
            raise BatchError(f'scene "{scene.name}" has no view layer "{options.view_layer}"; it has {names}')
        for other in scene.view_layers:
            other.use = other == layer
    scene.render.use_single_layer = False  # a switch for looking at one layer; Blender's own -f leaves it aside too
    chosen = [layer for layer in scene.view_layers if layer.use]
    if not chosen:
        raise BatchError(f'all view layers of scene "{scene.name}" are switched off: choose one with --view-layer')
    return chosen


def choose_camera(scene: bpy.types.Scene, options: argparse.Namespace) -> None:
    if options.camera is None:
        return
    camera = scene.objects.get(options.camera)
    if camera is None or camera.type != "CAMERA":
        names = list_names(thing.name for thing in scene.objects if thing.type == "CAMERA")
        raise BatchError(f'scene "{scene.name}" has no camera "{options.camera}"; its cameras are {names}')
    scene.camera = camera
    for marker in scene.timeline_markers:  # they would switch to their own cameras
        marker.camera = None


def set_picture(scene: bpy.types.Scene, options: argparse.Namespace) -> None:
    """Size, samples, threads and everything about the output that the batch decides."""
    render, settings = scene.render, scene.shadow_layers
    render.engine = ENGINE_ID
    render.use_compositing = render.use_sequencer = False
    if options.resolution is not None:
        render.resolution_x, render.resolution_y = options.resolution
        render.resolution_percentage = 100
    if options.samples is not None:
        settings.samples = options.samples
    if options.threads is not None:
        settings.threads = options.threads
    if options.backend is not None:
        settings.backend = options.backend


def get_owners(scene: bpy.types.Scene) -> list[Any]:
    """Whatever holds settings for the scene's lights: the scene, and the lights that override it."""
    lights = {thing.data.name_full: thing.data for thing in bpy.data.objects if thing.type == "LIGHT"}
    return [scene.shadow_layers, *(data.shadow_layers for data in lights.values())]


def choose_techniques(scene: bpy.types.Scene, options: argparse.Namespace) -> None:
    """Sets the scene's techniques, for lights with one of their own too."""
    if options.techniques is None:
        return
    for technique in options.techniques:
        if bridge.find_technique(technique)["test_only"]:
            raise BatchError(f'technique "{technique}" is for tests only')
    scene.shadow_layers.techniques = set(options.techniques)
    for owner in get_owners(scene)[1:]:
        if owner.mode == "OVERRIDE":
            owner.mode = "SCENE"


def parse_value(technique: str, parameter: dict[str, Any], text: str) -> Any:
    """A value of the parameter's type from the command line; the core checks its range."""
    kind, word = parameter["type"], text.strip().lower()
    place = f"{technique}.{parameter['id']}"
    if kind == "bool":
        if word not in TRUE_WORDS | FALSE_WORDS:
            raise BatchError(f'{place} is on or off, not "{text}"')
        return word in TRUE_WORDS
    if kind == "enum":
        known = [item["id"] for item in parameter["items"]]
        if text not in known:
            raise BatchError(f'{place} is one of {", ".join(known)}, not "{text}"')
        return text
    try:
        value = int(text) if kind == "int" else float(text)
    except ValueError as error:
        raise BatchError(f'{place} is a {"whole " if kind == "int" else ""}number, not "{text}"') from error
    return value


def set_parameters(scene: bpy.types.Scene, options: argparse.Namespace) -> None:
    """--map-size and --set, checked by the core, for the scene and for lights with settings of their own."""
    if options.map_size is not None:
        users = [i for i in properties.technique_infos() if any(p["id"] == "map_size" for p in i["parameters"])]
        if not users:
            raise BatchError("no technique has a map size")
        check_value(users[0]["id"], "map_size", options.map_size)
        for owner in get_owners(scene):
            owner.map_size = options.map_size
    for technique, name, text in options.settings:
        info = bridge.find_technique(technique)
        parameter = next((p for p in info["parameters"] if p["id"] == name), None)
        if parameter is None:
            known = ", ".join(p["id"] for p in info["parameters"])
            raise BatchError(f'technique "{technique}" has no parameter "{name}"; it has {known}')
        value = parse_value(technique, parameter, text)
        check_value(technique, name, value)
        for owner in get_owners(scene):
            setattr(owner if parameter["shared"] else getattr(owner, technique), name, value)


def check_value(technique: str, name: str, value: Any) -> None:
    """Raises ShadowLayersError naming technique, parameter, value and range: Blender would clamp in silence."""
    bridge.resolve_parameters(technique, {name: value})


def choose_lights(scene: bpy.types.Scene, layers: list[bpy.types.ViewLayer], options: argparse.Namespace) -> None:
    """Switches off the lights that aren't named. A light's settings are its data's, so data shared with a light that
    isn't wanted is parted."""
    if options.lights is None:
        return
    wanted = set(options.lights)
    rendered = {light.data for layer in layers for light in jobs.predicted_lights(scene, layer)}
    objects = {object_name(thing): thing for thing in bpy.data.objects if thing.type == "LIGHT"}
    there = sorted(name for name, thing in objects.items() if thing.data in rendered)
    for name in options.lights:
        if name not in there:
            raise BatchError(
                f'there is no light "{name}" to render; there are {list_names(there)} '
                "(instances are chosen by their light object)"
            )
    for name, thing in objects.items():
        if name in wanted:
            if thing.data.shadow_layers.mode == "OFF":
                thing.data.shadow_layers.mode = "SCENE"
        else:
            if thing.data.users > 1:
                thing.data = thing.data.copy()
            thing.data.shadow_layers.mode = "OFF"


def get_frames(scene: bpy.types.Scene, options: argparse.Namespace) -> list[int]:
    return [scene.frame_current] if options.frames is None else list(options.frames)


def set_up(options: argparse.Namespace, progress: Progress) -> tuple[bpy.types.Scene, list[bpy.types.ViewLayer]]:
    """Opens the file and puts all options into it. Raises BatchError and ShadowLayersError."""
    if options.file is None:
        open_file(options)
    else:
        with progress.step(f"opening {options.file}"):
            open_file(options)
    scene = choose_scene(options)
    layers = choose_view_layers(scene, options)
    choose_camera(scene, options)
    set_picture(scene, options)
    choose_techniques(scene, options)
    set_parameters(scene, options)
    choose_lights(scene, layers, options)
    return scene, layers
