# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The temporal part of the batch's verb compare: a short move of the lights or of the camera, or the scene's own
animation, and how much more the layers change from frame to frame than their truths (docs/measures.md)."""

from __future__ import annotations

import argparse
import contextlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .batch_files import BatchError, Progress
from .batch_render import render_frame
from .batch_truth import LightTruths, choose_kinds
from .capture import CapturedFrame
from .compare.pixels import Surface, classify_pixels
from .compare.temporal import SeenFrame, TemporalSums, find_same_places
from .light_export import object_name
from .scene_moves import MoveError, Mover
from .truth_store import TruthStore

AUX = ("position", "normal", "ids")
# Seen from the middle of the picture's contents. A light moves shadows by less than itself, the camera all of them.
DEFAULT_STEPS_DEG = {"light": 0.1, "camera": 0.02}


def check_frames(options: argparse.Namespace, frames: Sequence[int]) -> None:
    """Raises BatchError if the frames don't do for what --temporal asks for."""
    if options.temporal == "frames" and len(frames) < 2:
        raise BatchError("--temporal frames wants two frames or more: give them with --frames A..B")


@dataclass
class _Moment:
    """A light at one frame of the move: what is seen, and (layer, truth) by technique and kind of truth."""

    seen: SeenFrame
    pictures: dict[tuple[str, str], tuple[NDArray[np.floating], NDArray]]
    errors: dict[tuple[str, str], float | None]


class TemporalRun:
    """`notes` gathers what went wrong with the cache."""

    def __init__(
        self, options: argparse.Namespace, progress: Progress, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer
    ) -> None:
        self._options, self._progress = options, progress
        self._scene, self._view_layer = scene, view_layer
        self._before: dict[str, _Moment] = {}
        self._sums: dict[tuple[str, str, str], TemporalSums] = {}
        self._errors: dict[tuple[str, str, str], float | None] = {}
        self.notes: list[str] = []

    def run(self, frames: list[int]) -> list[dict[str, Any]]:
        """One record for each light, technique and truth; `frames` has passed check_frames. BatchError, TruthError."""
        kind = self._options.temporal
        if kind == "frames":
            for index, frame in enumerate(frames):
                self._add_moment(frame, f"temporal [{index + 1}/{len(frames)}] frame {frame}")
            return self._make_records(None, len(frames))
        count = self._options.temporal_frames
        step_deg = self._options.temporal_step or DEFAULT_STEPS_DEG[kind]
        with self._progress.step("temporal: looking where to move"):
            base = render_frame(self._scene, frames[0], aux=AUX)[0][0]
        with self._moving(kind, base) as mover:
            for index in range(count):
                mover.move(math.radians(index * step_deg))
                self._add_moment(frames[0], f"temporal [{index + 1}/{count}] {kind} moved {index * step_deg:g} degrees")
        return self._make_records(step_deg, count)

    @contextlib.contextmanager
    def _moving(self, kind: str, base: CapturedFrame) -> Iterator[Mover]:
        if not base.layers:
            raise BatchError("there is no layer whose changes could be measured: choose techniques with --techniques")
        seen = base.aux["position"][base.coverage > 0.5]
        if len(seen) == 0:
            raise BatchError(f"frame {base.frame}: the camera sees nothing, so there is nothing to move about")
        pivot_ws = np.median(seen, axis=0).astype(np.float64) + np.asarray(base.camera_position)
        names = {base.snapshot.lights[layer.job.light].name for layer in base.layers}
        things = [self._scene.camera]
        if kind == "light":
            things = [thing for thing in bpy.data.objects if thing.type == "LIGHT" and object_name(thing) in names]
        try:
            with Mover(self._scene, self._view_layer, things, pivot_ws) as mover:
                yield mover
        except MoveError as error:
            raise BatchError(str(error)) from error

    def _add_moment(self, frame: int, label: str) -> None:
        with self._progress.step(f"{label}: rendering the layers"):
            captured = render_frame(self._scene, frame, aux=AUX)[0][0]
        store = TruthStore(
            self._scene, self._view_layer, captured.snapshot,
            folder=self._options.cache, enabled=not self._options.no_cache, threads=self._options.threads or 0,
        )  # fmt: skip
        with store, self._progress.step(f"{label}: the truth"):
            surface = store.get_surface()[0]
            origin = np.asarray(captured.camera_position, dtype=np.float64)
            theirs = Surface(surface.positions_ws.astype(np.float64) - origin, surface.covered)
            for index in dict.fromkeys(layer.job.light for layer in captured.layers):
                moment = self._gather(captured, store, theirs, index)
                self._compare(captured.snapshot.lights[index].name, moment)
        self.notes += store.notes

    def _gather(self, captured: CapturedFrame, store: TruthStore, theirs: Surface, index: int) -> _Moment:
        """The layers and truths of one light in this frame."""
        snapshot = captured.snapshot
        light = snapshot.lights[index]
        hard = store.get_light(light)
        classes = classify_pixels(
            Surface(captured.aux["position"], captured.coverage > 0.5),
            theirs,
            captured.aux["normal"],
            hard[0].lit,
            camera=snapshot.camera,
            width=snapshot.render.width,
            height=snapshot.render.height,
            light=light,
        )
        seen = SeenFrame(
            captured.aux["position"],
            captured.aux["normal"],
            classes.comparable,
            np.asarray(captured.camera_position, dtype=np.float64),
            snapshot.camera,
        )
        truths = LightTruths(store, captured, hard, classes, sample_count=self._options.truth_samples)
        moment = _Moment(seen, {}, {})
        for layer in captured.layers:
            if layer.job.light != index:
                continue
            for kind in choose_kinds(self._options.truth, layer):
                truth = truths.get(layer, kind)
                moment.pictures[layer.technique, kind] = layer.channels["visibility"], truth.values
                moment.errors[layer.technique, kind] = truth.describe(classes.comparable)["standard_error"]["rms"]
        return moment

    def _compare(self, light: str, now: _Moment) -> None:
        before = self._before.get(light)
        self._before[light] = now
        if before is None:
            return
        places = find_same_places(before.seen, now.seen)
        for key, (layer, truth) in now.pictures.items():
            if key not in before.pictures:
                continue  # a technique that is switched on in this frame
            sums = self._sums.setdefault((light, *key), TemporalSums())
            sums.add(places, (before.pictures[key][0], layer), (before.pictures[key][1], truth))
            self._errors[(light, *key)] = now.errors[key]

    def _make_records(self, step_deg: float | None, count: int) -> list[dict[str, Any]]:
        return [
            {
                "light": light,
                "technique": technique,
                "truth": kind,
                "truth_standard_error": self._errors[light, technique, kind],
                "move": self._options.temporal,
                "step_deg": step_deg,
                "frames": count,
                "pixel_count": sums.pixel_count,
                "measures": sums.compute(),
            }
            for (light, technique, kind), sums in self._sums.items()
        ]
