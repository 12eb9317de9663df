# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""From lights and settings to jobs (light x technique), and from jobs to passes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from . import bridge, properties
from .light_export import LightNamer, is_portal, object_name
from .names import PassKey, pass_names
from .snapshot import Job


@dataclass
class SceneLight:
    """A light as the job list needs it: `data` is Blender's light (its `shadow_layers` holds the settings)."""

    name: str
    data: Any


@dataclass(frozen=True)
class PlannedPass:
    """A pass of the picture: output `output` (of `channels` channels) of job `job`."""

    name: str
    job: int
    output: str
    channels: int


def techniques_for(scene: Any, light: Any) -> list[tuple[dict[str, Any], Any]]:
    """(descriptor, owner of its settings) for a light: its own if it overrides, else the scene's."""
    own = light.shadow_layers
    if own.mode == "OFF":
        return []
    if own.mode == "OVERRIDE":
        if not own.technique:  # saved with a technique that this version doesn't have
            raise bridge.ShadowLayersError(
                f'light "{light.name}" asks for a technique that is not there; '
                "choose another in Object Data > Shadow Layers, or update the add-on"
            )
        return [(bridge.find_technique(own.technique), own)]
    return [(info, scene.shadow_layers) for info in properties.chosen_techniques(scene)]


def jobs_for(scene: Any, view_layer: Any, lights: Sequence[SceneLight], warnings: list[str] | None = None) -> list[Job]:
    """The jobs of a view layer: each light by each of its techniques, with every parameter's value.

    `Job.light` is the index into `lights`. A technique that doesn't serve a light's kind is left out and named in
    `warnings`. Empty if the view layer has its shadow layers switched off.
    """
    jobs: list[Job] = []
    if not scene.view_layers[view_layer.name].shadow_layers.enabled:
        return jobs
    for index, light in enumerate(lights):
        for info, owner in techniques_for(scene, light.data):
            if light.data.type in info["lights"]:
                jobs.append(Job(index, info["id"], properties.parameter_values(owner, info)))
            elif warnings is not None:
                kind = light.data.type.lower()
                warnings.append(f'{info["label"]} does not serve {kind} lights: "{light.name}" has no layer of it')
    return jobs


def plan_passes(light_names: Sequence[str], jobs: Sequence[Job]) -> list[PlannedPass]:
    """The passes that hold the jobs' outputs, with unique names that survive the EXR file."""
    keys, places = [], []
    for number, job in enumerate(jobs):
        for output in bridge.find_technique(job.technique)["outputs"]:
            label = "" if output["id"] == "visibility" else output["label"] or output["id"]
            keys.append(PassKey(light_names[job.light], job.technique, label))
            places.append((number, output["id"], int(output["channels"])))
    return [PlannedPass(name, *place) for name, place in zip(pass_names(keys), places, strict=True)]


def predicted_lights(scene: Any, view_layer: Any) -> list[SceneLight]:
    """The lights that a render of the view layer will find, read from the scene without evaluating it: those in its
    collections and in collection instances. Lights made by geometry nodes or particles are not foreseen; their passes
    are added while rendering and have no compositor socket."""
    namer = LightNamer()
    found = []
    # While rendering, Blender passes a bare copy of the view layer, whose collections crash 3.4 when read.
    view_layer = scene.view_layers.get(view_layer.name)
    if view_layer is None:
        return found
    for light, instancer in _walk(scene, view_layer):
        if not is_portal(light.data):
            found.append(SceneLight(namer.name(object_name(light), instancer), light.data))
    return found


def _walk(scene: Any, view_layer: Any) -> Iterator[tuple[Any, str | None]]:
    hidden = _hidden_collections(view_layer.layer_collection)
    for item in view_layer.objects:
        is_instancer = item.instance_type == "COLLECTION" and item.instance_collection is not None
        if (item.type != "LIGHT" and not is_instancer) or item.hide_render:
            continue
        if hidden and not any(c.name_full not in hidden for c in _collections_in(item, scene)):
            continue
        if item.type == "LIGHT":
            yield item, None
        if is_instancer:
            for member in item.instance_collection.all_objects:
                if member.type == "LIGHT" and not member.hide_render:
                    yield member, object_name(item)


def _hidden_collections(layer_collection: Any, hidden_above: bool = False) -> set[str]:
    """Names of the collections of a view layer that are off in renders, themselves or above."""
    collection = layer_collection.collection
    off = hidden_above or layer_collection.exclude or collection.hide_render
    hidden = {collection.name_full} if off else set()
    for child in layer_collection.children:
        # A child of an excluded collection may be included; one of a collection hidden in renders is hidden too.
        hidden |= _hidden_collections(child, hidden_above or collection.hide_render)
    return hidden


def _collections_in(item: Any, scene: Any) -> list[Any]:
    inside = list(item.users_collection)
    return inside if inside else [scene.collection]
