# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Truth from the cache where it is, rendered or computed where it isn't. The scene is touched only if Cycles must
render."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .capture import CapturedFrame, CapturedLayer
from .compare.light_squares import Footprint
from .compare.scene_triangles import SceneTriangles, gather_triangles
from .snapshot import LightData, SceneSnapshot
from .truth import (
    TRUTH_VERSION,
    CyclesTruth,
    LightTruth,
    SampledTruth,
    TruthError,
    TruthSurface,
    find_light_object,
)
from .truth_cache import TruthCache, compute_key
from .truth_filtered import FILTERED_VERSION, FilteredTruth, compute_filtered_truth

# What the truth depends on besides the snapshot, which knows neither hair nor volumes.
TRUTH_KIND = "hard"


def compute_scene_key(snapshot: SceneSnapshot) -> str:
    """Content key of geometry, camera and picture: all that a light's truth depends on besides the light."""
    camera, render = snapshot.camera, snapshot.render
    return compute_key(
        {"kind": TRUTH_KIND, "version": TRUTH_VERSION, "blender": bpy.app.version_string},
        {
            "perspective": bool(camera.perspective),
            "window": [float(value) for value in camera.window],
            "clip": [float(camera.clip_start), float(camera.clip_end)],
            "size": [int(render.width), int(render.height)],
        },
        np.asarray(camera.world_from_camera, dtype=np.float64),
        *(array for mesh in snapshot.meshes for array in (mesh.positions, mesh.triangles)),
        snapshot.instance_mesh,
        snapshot.instance_matrix,
        snapshot.instance_flags,
        snapshot.instance_receiver_group,
        snapshot.instance_blocker_group,
    )


def compute_light_key(scene_key: str, light: LightData) -> str:
    """Content key of a light's hard truth: its place and shape; not its energy, colour and size."""
    return compute_key(
        scene_key,
        {
            "kind": light.kind,
            "spot_angle": float(light.spot_angle) if light.kind == "SPOT" else 0.0,
            "spot_scale": [float(v) for v in light.spot_scale] if light.kind == "SPOT" else [],
            "casts_shadow": bool(light.casts_shadow),
            "receivers": int(light.receiver_set),
            "blockers": int(light.blocker_set),
        },
        np.asarray(light.world_from_light, dtype=np.float64),
    )


def compute_soft_key(light_key: str, light: LightData, sample_count: int) -> str:
    """Content key of a light's soft truth: of the hard one and the light's size."""
    size = {
        "SUN": [light.sun_angle],
        "POINT": [light.radius],
        "SPOT": [light.radius],
        "AREA": [*light.area_size, light.area_round],
    }[light.kind]
    return compute_key(light_key, {"truth": "soft", "size": [float(value) for value in size], "samples": sample_count})


def compute_filtered_key(
    light_key: str, layer: CapturedLayer, footprint: Footprint, sample_count: int, wanted: NDArray[np.bool_]
) -> str:
    """Content key of a filtered truth: of the hard one, the square, and where it is wanted."""
    return compute_key(
        light_key,
        {
            "truth": "filtered",
            "version": FILTERED_VERSION,
            "texels": footprint.texels,
            "world": footprint.world,
            "samples": sample_count,
            "views": [[view["perspective"], view["face"], *view["texel_size"]] for view in layer.views],
        },
        *(np.asarray(view["view_from_world"], dtype=np.float64) for view in layer.views),
        wanted,
    )


class TruthStore:
    """Truth of one frame.

        with TruthStore(scene, view_layer, snapshot) as store:
            surface, from_cache = store.get_surface()
            truth, from_cache = store.get_light(snapshot.lights[0])

    `snapshot` must be of the scene's current frame. `notes` tells what went wrong with the cache.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        snapshot: SceneSnapshot,
        *,
        folder: Path | None = None,
        enabled: bool = True,
        threads: int = 0,
    ) -> None:
        self._scene, self._view_layer, self._snapshot = scene, view_layer, snapshot
        self._threads = threads
        self._cache = TruthCache(folder) if enabled else None
        self._scene_key = compute_scene_key(snapshot) if enabled else ""
        self._stack = contextlib.ExitStack()
        self._cycles: CyclesTruth | None = None
        self._triangles: SceneTriangles | None = None
        self.notes: list[str] = []

    def __enter__(self) -> TruthStore:
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.__exit__(*error)
        self._cycles = None

    def check_light(self, light: LightData) -> None:
        """Raises TruthError for a light that Cycles can't render by itself: an instance, or one that is instanced."""
        if any(other.name.startswith(f"{light.name} @") for other in self._snapshot.lights):
            raise TruthError(
                f'"{light.name}" is instanced too, and Cycles can not tell it from its instances: '
                "choose other lights with --lights"
            )
        find_light_object(light.name)

    def get_surface(self) -> tuple[TruthSurface, bool]:
        """What Cycles sees, and whether it came from the cache."""
        found = self._load(self._scene_key)
        if found is not None:
            return TruthSurface(found["positions_ws"], found["covered"], float(found["time_ms"])), True
        surface = self._get_cycles().render_surface()
        self._store(self._scene_key, {
            "positions_ws": surface.positions_ws, "covered": surface.covered, "time_ms": np.float64(surface.time_ms),
        })  # fmt: skip
        return surface, False

    def get_light(self, light: LightData) -> tuple[LightTruth, bool]:
        """A light's truth, and whether it came from the cache. Raises TruthError."""
        self.check_light(light)
        key = self._compute_light_key(light)
        found = self._load(key)
        if found is not None:
            times = dict(zip(found["stages"].tolist(), found["times_ms"].tolist(), strict=True))
            return LightTruth(found["visible"], found["lit"], int(found["undecided"]), times), True
        truth = self._get_cycles().render_light(light.name)
        self._store(key, {
            "visible": truth.visible,
            "lit": truth.lit,
            "undecided": np.int64(truth.undecided_count),
            "stages": np.array(list(truth.times_ms)),
            "times_ms": np.array(list(truth.times_ms.values())),
        })  # fmt: skip
        return truth, False

    def get_reached(self, light: LightData) -> NDArray[np.bool_]:
        """The pixels (h, w) that the light, made hard, reaches: for where a border lies. Raises TruthError."""
        self.check_light(light)
        light_key = self._compute_light_key(light)
        key = compute_key(light_key, {"truth": "reached"})
        found = self._load(key)
        if found is not None:
            width = int(found["width"])
            return np.unpackbits(found["reached"], axis=1, count=width).astype(bool)
        reached, _ = self._get_cycles().render_reached(light.name)
        self._store(key, {"reached": np.packbits(reached, axis=1), "width": np.int64(reached.shape[1])})
        return reached

    def get_soft(self, light: LightData, sample_count: int) -> tuple[SampledTruth, bool]:
        """The truth of a light in its real size, and whether it came from the cache. Raises TruthError."""
        light_key = self._compute_light_key(light)
        key = compute_soft_key(light_key, light, sample_count)
        return self._get_sampled(light, key, lambda: self._get_cycles().render_soft_light(light.name, sample_count))

    def get_pixel(self, light: LightData, sample_count: int) -> tuple[SampledTruth, bool]:
        """The hard truth's mean over each pixel's square, and whether it came from the cache. Raises TruthError."""
        key = compute_key(self._compute_light_key(light), {"truth": "pixel", "samples": sample_count})
        return self._get_sampled(light, key, lambda: self._get_cycles().render_pixel_light(light.name, sample_count))

    def _get_sampled(self, light: LightData, key: str, render: Callable[[], SampledTruth]) -> tuple[SampledTruth, bool]:
        self.check_light(light)
        found = self._load(key)
        if found is not None:
            times = dict(zip(found["stages"].tolist(), found["times_ms"].tolist(), strict=True))
            truth = SampledTruth(found["visibility"], found["error"], found["lit"], int(found["samples"]), times)
            return truth, True
        truth = render()
        self._store(key, {
            "visibility": truth.visibility,
            "error": truth.error,
            "lit": truth.lit,
            "samples": np.int64(truth.samples),
            "stages": np.array(list(truth.times_ms)),
            "times_ms": np.array(list(truth.times_ms.values())),
        })  # fmt: skip
        return truth, False

    def get_filtered(
        self,
        captured: CapturedFrame,
        layer: CapturedLayer,
        footprint: Footprint,
        sample_count: int,
        wanted: NDArray[np.bool_],
    ) -> tuple[FilteredTruth, bool]:
        """The exact mask of the layer's light, averaged over the square in the layer's map, at the pixels `wanted`
        (h, w); and whether it came from the cache. Raises TruthError."""
        light = self._snapshot.lights[layer.job.light]
        light_key = self._compute_light_key(light)
        key = compute_filtered_key(light_key, layer, footprint, sample_count, wanted)
        found = self._load(key)
        if found is not None:
            numbers = int(found["samples"]), int(found["sampled_count"]), float(found["time_ms"])
            return FilteredTruth(found["visibility"], found["error"], *numbers), True
        if self._triangles is None:
            self._triangles = gather_triangles(self._snapshot)
        truth = compute_filtered_truth(
            captured, self._triangles, layer, footprint, sample_count, wanted=wanted, threads=self._threads
        )
        self._store(key, {
            "visibility": truth.visibility,
            "error": truth.error,
            "samples": np.int64(truth.samples),
            "sampled_count": np.int64(truth.sampled_count),
            "time_ms": np.float64(truth.time_ms),
        })  # fmt: skip
        return truth, False

    def _compute_light_key(self, light: LightData) -> str:
        return compute_light_key(self._scene_key, light) if self._cache is not None else ""

    def _get_cycles(self) -> CyclesTruth:
        if self._cycles is None:
            size = self._snapshot.render
            self._cycles = self._stack.enter_context(
                CyclesTruth(self._scene, self._view_layer, size.width, size.height, self._threads)
            )
        return self._cycles

    def _load(self, key: str) -> dict[str, Any] | None:
        if self._cache is None:
            return None
        found = self._cache.load(key)
        self._take_note()
        return found

    def _store(self, key: str, arrays: dict[str, Any]) -> None:
        if self._cache is not None:
            self._cache.store(key, arrays)
            self._take_note()

    def _take_note(self) -> None:
        if self._cache.last_error:
            self.notes.append(self._cache.last_error)
            self._cache.last_error = ""
