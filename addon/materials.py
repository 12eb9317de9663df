# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material means for shadows: opaque, fully transparent, or something in between that is taken as opaque."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import bpy

_EPSILON = 1e-5
_MAX_DEPTH = 64  # node trees may be deep, but a loop must end


class Opacity(Enum):
    """OPAQUE casts, TRANSPARENT is neither seen nor casts, PARTIAL is treated as opaque and named."""

    OPAQUE = 0
    TRANSPARENT = 1
    PARTIAL = 2


@dataclass(frozen=True)
class MaterialFacts:
    """What the export needs to know of a material."""

    opacity: Opacity = Opacity.OPAQUE
    emits: bool = False
    displaces: bool = False  # moves the surface itself, not its shading alone


OPAQUE_FACTS = MaterialFacts()


def _uses_nodes(owner: Any) -> bool:
    # Since 5.0 nodes are always used, and the switch is only kept for scripts.
    return owner.node_tree is not None and (bpy.app.version >= (5, 0) or owner.use_nodes)


def examine(material: Any) -> MaterialFacts:
    """Reads a material's nodes. None (an empty slot) is opaque, as in Cycles."""
    if material is None or not _uses_nodes(material):
        return OPAQUE_FACTS
    tree = material.node_tree
    output = tree.get_output_node("CYCLES") or tree.get_output_node("ALL")
    if output is None:
        return OPAQUE_FACTS
    displaces = _moves_surface(material, output)
    surface, volume = output.inputs.get("Surface"), output.inputs.get("Volume")
    if surface is None or not surface.is_linked:
        # Cycles lets rays through a closed surface that holds a volume alone; with neither it is black.
        transparent = volume is not None and volume.is_linked
        return MaterialFacts(Opacity.TRANSPARENT if transparent else Opacity.OPAQUE, displaces=displaces)
    return MaterialFacts(_opacity(surface, (), 0), _emits(surface, (), 0), displaces)


def _moves_surface(material: Any, output: Any) -> bool:
    """True displacement, which Blender 4.1 moved out of the Cycles add-on's properties."""
    owner = material if hasattr(material, "displacement_method") else getattr(material, "cycles", None)
    displacement = output.inputs.get("Displacement")
    linked = displacement is not None and displacement.is_linked
    return linked and getattr(owner, "displacement_method", "BUMP") in {"DISPLACEMENT", "BOTH"}


def is_even_light(light: Any) -> bool:
    """Whether a light's nodes, if it has any, make it shine alike all over: a plain emission."""
    if light.node_tree is None or not light.use_nodes:
        return True
    output = light.node_tree.get_output_node("CYCLES") or light.node_tree.get_output_node("ALL")
    source = _source(output.inputs["Surface"], ()) if output is not None else None
    if source is None:
        return True  # Cycles shows no light at all
    node, _output, path = source
    constants = (_constant(node.inputs.get(name), path) for name in ("Strength", "Color"))
    return node.type == "EMISSION" and not node.mute and None not in constants


def _source(socket: Any, path: tuple) -> tuple[Any, Any, tuple] | None:
    """(node, output socket, path of group nodes) that feeds an input; through reroutes and node groups."""
    for _ in range(_MAX_DEPTH):
        if not socket.is_linked:
            return None
        link = socket.links[0]
        node, output = link.from_node, link.from_socket
        if getattr(link, "is_muted", False):
            return None
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "GROUP" and node.node_tree is not None:
            inner = next((n for n in node.node_tree.nodes if n.type == "GROUP_OUTPUT" and n.is_active_output), None)
            index = list(node.outputs).index(output)
            if inner is None or index >= len(inner.inputs):
                return None
            path, socket = (*path, node), inner.inputs[index]
        elif node.type == "GROUP_INPUT" and path:
            group, index = path[-1], list(node.outputs).index(output)
            if index >= len(group.inputs):
                return None
            path, socket = path[:-1], group.inputs[index]
        else:
            return node, output, path
    return None


def _constant(socket: Any, path: tuple) -> float | None:
    """The value of an input that no texture feeds, else None."""
    if socket is None:
        return None
    source = _source(socket, path)
    if source is not None:
        node, output, _ = source
        return float(output.default_value) if node.type == "VALUE" else None
    if socket.is_linked:  # ends in an unlinked reroute or group socket, whose value is not read here
        return None
    value = socket.default_value
    return float(value) if isinstance(value, int | float) else max(value[:3])


def _opacity(socket: Any, path: tuple, depth: int) -> Opacity:
    source = _source(socket, path) if depth < _MAX_DEPTH else None
    if source is None:
        return Opacity.OPAQUE
    node, _output, path = source
    if node.mute:
        return Opacity.PARTIAL
    if node.type == "BSDF_TRANSPARENT":
        color = node.inputs["Color"]
        see_through = None if color.is_linked else {round(v, 5) for v in color.default_value[:3]}
        return _by_extremes(see_through)
    if node.type == "BSDF_PRINCIPLED":
        alpha = _constant(node.inputs["Alpha"], path)
        return _by_extremes(None if alpha is None else {round(1 - min(max(alpha, 0.0), 1.0), 5)})
    if node.type in {"MIX_SHADER", "ADD_SHADER"}:
        return _joined(node, path, depth)
    return Opacity.OPAQUE


def _by_extremes(see_through: set[float] | None) -> Opacity:
    """From the channels' transparency, 0..1; None where a texture drives it."""
    if see_through is not None and min(see_through) >= 1:
        return Opacity.TRANSPARENT
    return Opacity.OPAQUE if see_through is not None and max(see_through) <= 0 else Opacity.PARTIAL


def _joined(node: Any, path: tuple, depth: int) -> Opacity:
    if node.type == "ADD_SHADER":
        parts = {_opacity(node.inputs[i], path, depth + 1) for i in range(2)}
        return Opacity.OPAQUE if parts == {Opacity.OPAQUE} else Opacity.PARTIAL
    factor = _constant(node.inputs[0], path)
    if factor is not None and factor <= _EPSILON:
        return _opacity(node.inputs[1], path, depth + 1)
    if factor is not None and factor >= 1 - _EPSILON:
        return _opacity(node.inputs[2], path, depth + 1)
    parts = {_opacity(node.inputs[i], path, depth + 1) for i in (1, 2)}
    return parts.pop() if len(parts) == 1 else Opacity.PARTIAL


def _emits(socket: Any, path: tuple, depth: int) -> bool:
    source = _source(socket, path) if depth < _MAX_DEPTH else None
    if source is None:
        return False
    node, _output, path = source
    if node.type == "EMISSION":
        return _is_bright(node.inputs["Strength"], path) and _is_bright(node.inputs["Color"], path)
    if node.type == "BSDF_PRINCIPLED":
        color = node.inputs.get("Emission Color") or node.inputs.get("Emission")
        return _is_bright(node.inputs.get("Emission Strength"), path) and _is_bright(color, path)
    if node.type in {"MIX_SHADER", "ADD_SHADER"}:
        shaders = [s for s in node.inputs if s.type == "SHADER"]
        return any(_emits(s, path, depth + 1) for s in shaders)
    return False


def _is_bright(socket: Any, path: tuple) -> bool:
    value = _constant(socket, path)
    return value is None or value > _EPSILON


def world_lights(world: Any) -> bool:
    """Whether the world sheds light (its light has no layer)."""
    if world is None:
        return False
    if not _uses_nodes(world):
        return max(world.color) > _EPSILON
    tree = world.node_tree
    output = tree.get_output_node("CYCLES") or tree.get_output_node("ALL")
    source = _source(output.inputs["Surface"], ()) if output is not None else None
    if source is None:
        return False
    node, _output, path = source
    if node.type == "BACKGROUND":
        return _is_bright(node.inputs["Strength"], path) and _is_bright(node.inputs["Color"], path)
    return True
