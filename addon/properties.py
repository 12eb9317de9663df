# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings on scenes and lights, made from the core's technique descriptors.

`scene.shadow_layers`: `techniques` (set of ids), `samples`, `backend`, `threads`, each shared parameter by its id
(`map_size`), and one group per technique by its id (`scene.shadow_layers.edsm.softness`).
`light.shadow_layers` (on the light's data): `mode` SCENE, OVERRIDE or OFF, `technique`, and the same parameters.
`view_layer.shadow_layers`: `enabled`.

Whether a technique is chosen is stored as one Boolean per technique (`use_<id>`), so that files survive a change of the
registry's order; `techniques` is a view of them.
"""

from __future__ import annotations

import zlib
from typing import Any

import bpy
import numpy as np

from . import bridge

GROUP_PREFIX = "SHADOWLAYERS_PG_"
DEFAULT_TECHNIQUES = ("edsm", "sm")  # the first that is there
_RESERVED = {"techniques", "samples", "backend", "threads", "mode", "technique", "name", "bl_rna", "rna_type"}
_classes: list[type] = []
# Blender keeps no reference to the strings of dynamic enums; these lists do.
_technique_items: list[tuple[str, str, str, int]] = []


def enum_number(identifier: str) -> int:
    """A number for an enum item that doesn't depend on the items around it (files store the number)."""
    return zlib.crc32(identifier.encode()) & 0x7FFFFFFF


def technique_infos() -> list[dict[str, Any]]:
    """Descriptors of the techniques offered to users; empty without the native module."""
    return bridge.techniques()


def shared_parameters() -> list[dict[str, Any]]:
    """Each shared parameter once, in order of first appearance."""
    found: dict[str, dict[str, Any]] = {}
    for info in technique_infos():
        for parameter in info["parameters"]:
            if parameter["shared"]:
                found.setdefault(parameter["id"], parameter)
    return list(found.values())


def own_parameters(info: dict[str, Any]) -> list[dict[str, Any]]:
    return [parameter for parameter in info["parameters"] if not parameter["shared"]]


def _description(parameter: dict[str, Any]) -> str:
    unit = f" ({parameter['unit']})" if parameter["unit"] else ""
    return (parameter["help"].rstrip().rstrip(".") or parameter["label"]) + unit


def round_inwards(low: float, high: float) -> tuple[float, float]:
    """Bounds as float32, which Blender keeps them in: rounded to the nearest one the least value could lie below what
    the core takes."""
    first, last = np.float32(low), np.float32(high)
    if float(first) < low:
        first = np.nextafter(first, np.float32(np.inf))
    if float(last) > high:
        last = np.nextafter(last, np.float32(-np.inf))
    return float(first), float(last)


def make_property(parameter: dict[str, Any]) -> Any:
    """A bpy property from a ParameterInfo."""
    common = {"name": parameter["label"], "description": _description(parameter)}
    kind, default = parameter["type"], parameter["default"]
    if kind == "bool":
        return bpy.props.BoolProperty(default=bool(default), **common)
    if kind == "int":
        step = max(int(parameter["step"]), 1)
        limits = {"min": int(parameter["min"]), "max": int(parameter["max"]), "step": step}
        if step > 1:
            limits["update"] = _snap_int(parameter["id"], limits["min"], step)
        return bpy.props.IntProperty(default=int(default), **limits, **common)
    if kind == "float":
        low, high = round_inwards(float(parameter["min"]), float(parameter["max"]))
        return bpy.props.FloatProperty(default=float(default), min=low, max=high, step=10, **common)
    items = [(i["id"], i["label"], i["help"], enum_number(i["id"])) for i in parameter["items"]]
    return bpy.props.EnumProperty(items=items, default=str(default), **common)


def _snap_int(name: str, low: int, step: int):
    """An update callback that moves the value down to low + k * step (sizes that must be odd, say)."""

    def update(group: Any, _context: Any) -> None:
        value = getattr(group, name)
        allowed = low + (value - low) // step * step
        if value != allowed:
            setattr(group, name, allowed)

    return update


def _technique_flags(group: Any) -> int:
    return sum(1 << bit for bit, info in enumerate(technique_infos()) if getattr(group, "use_" + info["id"]))


def _set_technique_flags(group: Any, value: int) -> None:
    for bit, info in enumerate(technique_infos()):
        setattr(group, "use_" + info["id"], bool(value >> bit & 1))


def default_technique() -> str:
    ids = [info["id"] for info in technique_infos()]
    return next((wanted for wanted in DEFAULT_TECHNIQUES if wanted in ids), ids[0] if ids else "")


def _make_group(name: str, annotations: dict[str, Any], doc: str) -> type:
    group = type(GROUP_PREFIX + name, (bpy.types.PropertyGroup,), {"__annotations__": annotations, "__doc__": doc})
    bpy.utils.register_class(group)
    _classes.append(group)
    return group


def _technique_groups() -> dict[str, Any]:
    """Annotations: a pointer per technique with parameters of its own, and the shared parameters."""
    annotations = {parameter["id"]: make_property(parameter) for parameter in shared_parameters()}
    for info in technique_infos():
        own = own_parameters(info)
        if not own:
            continue
        group = next((c for c in _classes if c.__name__ == GROUP_PREFIX + info["id"]), None)
        if group is None:
            group = _make_group(info["id"], {p["id"]: make_property(p) for p in own}, f"Parameters of {info['label']}")
        annotations[info["id"]] = bpy.props.PointerProperty(type=group, name=info["label"])
    clashes = _RESERVED & annotations.keys()
    if clashes:
        raise RuntimeError(f"technique or shared parameter ids clash with settings of the add-on: {sorted(clashes)}")
    return annotations


def _scene_annotations() -> dict[str, Any]:
    chosen = default_technique()
    annotations = {
        "use_" + info["id"]: bpy.props.BoolProperty(
            name=info["label"], description=info["summary"], default=info["id"] == chosen
        )
        for info in technique_infos()
    }
    flags = [(info["id"], info["label"], info["summary"], 1 << bit) for bit, info in enumerate(technique_infos())]
    if flags:
        annotations["techniques"] = bpy.props.EnumProperty(
            name="Techniques",
            description="The techniques whose layers are rendered, for every light that has no override",
            items=flags,
            options={"ENUM_FLAG"},
            get=_technique_flags,
            set=_set_technique_flags,
        )
    annotations["samples"] = bpy.props.IntProperty(
        name="Samples",
        description="Jittered pictures per pixel, joined by the scene's pixel filter; 1 takes the pixel's centre",
        default=4,
        min=1,
        max=64,
    )
    annotations["backend"] = bpy.props.EnumProperty(
        name="Back End",
        description="Where the core draws its maps",
        items=[("PREFERENCES", "As in Preferences", "What the add-on's preferences say", 0), *backend_items(1)],
        default="PREFERENCES",
    )
    annotations["threads"] = bpy.props.IntProperty(
        name="Threads", description="CPU threads; 0 takes what the add-on's preferences say", default=0, min=0, max=256
    )
    return {**annotations, **_technique_groups()}


def backend_items(start: int = 0) -> list[tuple[str, str, str, int]]:
    """Enum items of the core's back ends."""
    return [
        ("auto", "Automatic", "A GPU through EGL if there is one, else the software rasteriser", start),
        ("osmesa", "OSMesa", "Mesa's software rasteriser, without a window system", start + 1),
        ("egl", "EGL", "The driver's EGL, without a window", start + 2),
    ]


def _light_annotations() -> dict[str, Any]:
    modes = [
        ("SCENE", "As Scene", "The techniques and parameters of the scene", 0),
        ("OVERRIDE", "Own", "A technique and parameters of its own", 1),
        ("OFF", "Off", "No layers for this light; it takes no part in the picture", 2),
    ]
    annotations = {
        "mode": bpy.props.EnumProperty(
            name="Shadow Layers", description="What is rendered for this light", items=modes, default="SCENE"
        )
    }
    _technique_items[:] = [(i["id"], i["label"], i["summary"], enum_number(i["id"])) for i in technique_infos()]
    if _technique_items:
        annotations["technique"] = bpy.props.EnumProperty(
            name="Technique",
            description="The technique of this light's layers",
            items=_technique_items,
            default=default_technique(),
        )
    return {**annotations, **_technique_groups()}


def _view_layer_annotations() -> dict[str, Any]:
    enabled = bpy.props.BoolProperty(
        name="Shadow Layers", description="Render the lights' shadow layers in this view layer", default=True
    )
    return {"enabled": enabled}


def parameter_values(owner: Any, info: dict[str, Any]) -> dict[str, Any]:
    """All parameters of a technique from `scene.shadow_layers` or `light.shadow_layers`, as plain Python values."""
    values = {}
    for parameter in info["parameters"]:
        group = owner if parameter["shared"] else getattr(owner, info["id"])
        values[parameter["id"]] = getattr(group, parameter["id"])
    return values


def chosen_techniques(scene: bpy.types.Scene) -> list[dict[str, Any]]:
    """Descriptors of the scene's techniques, in menu order."""
    settings = scene.shadow_layers
    return [info for info in technique_infos() if getattr(settings, "use_" + info["id"], False)]


def register() -> None:
    scene_group = _make_group("scene", _scene_annotations(), "Settings of Shadow Layers for a scene")
    light_group = _make_group("light", _light_annotations(), "Settings of Shadow Layers for a light")
    layer_group = _make_group("view_layer", _view_layer_annotations(), "Settings of Shadow Layers for a view layer")
    bpy.types.ViewLayer.shadow_layers = bpy.props.PointerProperty(type=layer_group, name="Shadow Layers")
    bpy.types.Scene.shadow_layers = bpy.props.PointerProperty(type=scene_group, name="Shadow Layers")
    bpy.types.Light.shadow_layers = bpy.props.PointerProperty(type=light_group, name="Shadow Layers")


def unregister() -> None:
    for owner in (bpy.types.Light, bpy.types.Scene, bpy.types.ViewLayer):
        if hasattr(owner, "shadow_layers"):
            del owner.shadow_layers
    while _classes:
        bpy.utils.unregister_class(_classes.pop())
