# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch's verb compare: layers against the truth from Cycles. Numbers, pictures and one page."""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np

from .batch_border import BorderSource
from .batch_causes import CauseSource
from .batch_done import DoneBefore
from .batch_files import BatchError, FileNamer, Progress, make_output_folder, write_bytes, write_json
from .batch_measure import LightMeasurer
from .batch_render import describe_frame, get_wanted, make_document, render_frame
from .batch_scene import get_frames, get_owners, set_up
from .batch_temporal import TemporalRun, check_frames
from .batch_truth import LightTruths, choose_kinds
from .capture import CapturedFrame, CapturedLayer
from .compare import flip
from .compare.measures import MEASURES
from .compare.pixels import Surface, classify_pixels
from .compare.report import LightEntry, build_page
from .compare.table import format_table, format_temporal_table
from .compare.temporal import TEMPORAL_MEASURES
from .scene_guard import SceneGuard
from .truth_store import TruthStore

COMPARE_SCHEMA, COMPARE_SCHEMA_VERSION = "shadow-layers-comparison", 1
AUX = ("position", "normal", "ids")
WARM_UP_PX, WARM_UP_MAP_SIZE = 16, 64


def run_compare(options: argparse.Namespace, progress: Progress) -> None:
    scene, view_layers = set_up(options, progress)
    if len(view_layers) > 1:
        names = ", ".join(f'"{layer.name}"' for layer in view_layers)
        raise BatchError(f"several view layers are enabled ({names}): choose the one to compare with --view-layer")
    if options.samples not in (None, 1):
        progress.say("compare takes one sample, at the pixel's centre; --samples is left aside")
    scene.shadow_layers.samples = 1
    scene.render.use_border = False
    folder = make_output_folder(options.out)
    json_path = options.json or folder / "comparison.json"
    make_output_folder(json_path.parent)
    page_path = folder / "index.html"
    frames = get_frames(scene, options)
    check_frames(options, frames)
    if options.skip_existing and page_path.is_file():
        done_before = DoneBefore(json_path, folder, make_head(options, scene))
        wanted = get_wanted(scene, view_layers)
        if all(done_before.find(frame, wanted, "records") for frame in frames):
            progress.say(f"the comparison is there already: {page_path}")
            return
    comparison = _Comparison(options, progress, scene, view_layers[0])
    comparison.warm_up(frames[0])
    for index, frame in enumerate(frames):
        comparison.add_frame(frame, f"[{index + 1}/{len(frames)}] frame {frame}")
    if options.temporal:
        comparison.add_temporal(frames)
    document = comparison.make_document()
    write_json(json_path, document)
    write_bytes(page_path, comparison.make_page(document).encode())
    progress.say(format_table(document["records"]))
    if document["temporal"]:
        progress.say(format_temporal_table(document["temporal"]))
    progress.say(f"{len(document['records'])} layers are compared in {page_path} and {json_path}")


def make_head(options: argparse.Namespace, scene: bpy.types.Scene) -> dict[str, Any]:
    """How comparison.json begins: what two runs must have in common to be one."""
    return {
        **make_document(COMPARE_SCHEMA, COMPARE_SCHEMA_VERSION, scene),
        "truths": options.truth,
        "truth_samples": options.truth_samples,
        "border_samples": options.border_samples,
        "causes": options.causes,
        "temporal_move": [options.temporal, options.temporal_frames, options.temporal_step],
    }


class _Comparison:
    """Goes through the frames and keeps what the documents need: records and pictures, no float layers."""

    def __init__(
        self, options: argparse.Namespace, progress: Progress, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer
    ) -> None:
        self._options, self._progress = options, progress
        self._scene, self._view_layer = scene, view_layer
        self._namer = FileNamer()
        self._records: list[dict[str, Any]] = []
        self._frames: list[dict[str, Any]] = []
        self._temporal: list[dict[str, Any]] = []
        self._lights: list[LightEntry] = []
        self._notes: list[str] = []
        self._again_ms: list[float | None] = []
        self._frame = 0

    def add_frame(self, frame: int, label: str) -> None:
        """Renders and measures a frame. Raises BatchError, TruthError."""
        self._frame = frame
        captured, frame_record = self._render_layers(frame, label)
        by_light: dict[int, list[CapturedLayer]] = {}
        for layer in captured.layers:
            by_light.setdefault(layer.job.light, []).append(layer)
        if not by_light:
            raise BatchError(f"frame {frame}: there is no layer to compare: choose techniques with --techniques")
        snapshot = captured.snapshot
        size = snapshot.render.width, snapshot.render.height
        ours = Surface(captured.aux["position"], captured.coverage > 0.5)
        store = TruthStore(
            self._scene, self._view_layer, snapshot,
            folder=self._options.cache, enabled=not self._options.no_cache, threads=self._options.threads or 0,
        )  # fmt: skip
        borders = BorderSource(
            self._scene, self._view_layer, captured, samples=self._options.border_samples,
            folder=self._options.cache, enabled=not self._options.no_cache, threads=self._options.threads or 0,
        )  # fmt: skip
        for index in by_light:
            store.check_light(snapshot.lights[index])  # told before Cycles renders the others
        masks_ms: dict[str, float] = {}
        with store:
            with self._progress.step(f"{label}: Cycles, what the camera sees"):
                surface, surface_cached = store.get_surface()
            frame_record["truth_surface_ms"] = round(surface.time_ms, 4)
            frame_record["truth_surface_cached"] = surface_cached
            origin = np.asarray(captured.camera_position, dtype=np.float64)
            theirs = Surface(surface.positions_ws.astype(np.float64) - origin, surface.covered)
            causes = CauseSource(captured, theirs.positions_rel, self._options.causes) if self._options.causes else None
            for index, layers in by_light.items():
                light = snapshot.lights[index]
                with self._progress.step(f'{label}: Cycles, the shadow of "{light.name}"'):
                    hard = store.get_light(light)
                with self._progress.step(f"{label}: comparing what is seen"):
                    classes = classify_pixels(
                        ours, theirs, captured.aux["normal"], hard[0].lit,
                        camera=snapshot.camera, width=size[0], height=size[1], light=light,
                    )  # fmt: skip
                truths = LightTruths(store, captured, hard, classes, sample_count=self._options.truth_samples)
                measurer = LightMeasurer(
                    captured, hard, classes, borders, light=index,
                    write_picture=self._write_picture, again_ms=self._again_ms, causes=causes,
                )  # fmt: skip
                self._measure_light(f'{label}: "{light.name}"', layers, truths, measurer)
                masks_ms[light.name] = sum(hard[0].times_ms.values())
                if hard[0].undecided_count:
                    self._note(
                        f"{light.name}: {hard[0].undecided_count} pixels of the hard truth are neither lit nor in "
                        "shadow (transparent or unsupported geometry); each counts as what it is nearer to."
                    )
        frame_record["truth_ms"] = round(sum(masks_ms.values()), 4)
        self._frames.append(frame_record)
        self._progress.say(
            f"{label}: F12 {frame_record['render_ms']:.0f} ms for {len(captured.layers)} layers, "
            f"lights: {len(masks_ms)}; Cycles' masks of these lights {frame_record['truth_ms']:.0f} ms, "
            f"{frame_record['truth_ms'] / frame_record['render_ms']:.1f} times as long"
        )
        self._note(*captured.warnings, *store.notes, *borders.notes)

    def add_temporal(self, frames: list[int]) -> None:
        """Measures changes from frame to frame. Raises BatchError, TruthError."""
        run = TemporalRun(self._options, self._progress, self._scene, self._view_layer)
        self._temporal = run.run(frames)
        self._note(*run.notes)

    def _render_layers(self, frame: int, label: str) -> tuple[CapturedFrame, dict[str, Any]]:
        """The layers of a frame. Times are those of the first render: as in an animation, programs and meshes are
        there, maps are not. With --repeat more follow, in which the maps are there too."""
        with self._progress.step(f"{label}: rendering the layers"):
            frames, render_ms = render_frame(self._scene, frame, aux=AUX)
        captured = frames[0]
        record = describe_frame(self._scene, captured, render_ms)
        again = []
        for run in range(1, self._options.repeat):
            with self._progress.step(f"{label}: rendering the layers again ({run + 1} of {self._options.repeat})"):
                again.append(render_frame(self._scene, frame, aux=AUX))
        if again:
            record["render_again_ms"] = round(statistics.median(time_ms for _, time_ms in again), 4)
        self._again_ms = [
            statistics.median(other[0].layers[index].total_ms for other, _ in again) if again else None
            for index in range(len(captured.layers))
        ]
        return captured, record

    def warm_up(self, frame: int) -> None:
        """Starts GL, compiles the programs and loads the meshes with a small picture and small maps, whose results
        serve nothing else: so that times are those of any frame but the first."""
        render = self._scene.render
        with SceneGuard() as guard:
            guard.set(render, "resolution_x", WARM_UP_PX)
            guard.set(render, "resolution_y", WARM_UP_PX)
            guard.set(render, "resolution_percentage", 100)
            for owner in get_owners(self._scene):
                if hasattr(owner, "map_size"):
                    guard.set(owner, "map_size", WARM_UP_MAP_SIZE)
            with self._progress.step("warming up"):
                render_frame(self._scene, frame)

    def _measure_light(
        self, label: str, layers: Sequence[CapturedLayer], truths: LightTruths, measurer: LightMeasurer
    ) -> None:
        """Each layer against each truth that is wanted of it."""
        for layer in layers:
            for kind in choose_kinds(self._options.truth, layer):
                with self._progress.step(f"{label}, the {kind} truth of {layer.technique}"):
                    truth = truths.get(layer, kind)
                with self._progress.step(f"{label}, measuring {layer.technique}"):
                    measurer.measure(layer, truth)
        self._records += measurer.records
        self._lights += measurer.entries

    def _write_picture(self, png: bytes, *parts: str) -> str:
        """Under a name that `render` gives to none of its pictures, so that both may write into one folder."""
        ending = f"_{self._frame:04d}" if self._options.frames is not None else ""
        path = self._options.out / (self._namer.make_name(*parts) + ending + ".png")
        write_bytes(path, png)
        return path.name

    def _note(self, *notes: str) -> None:
        self._notes += [note for note in dict.fromkeys(notes) if note and note not in self._notes]

    def make_document(self) -> dict[str, Any]:
        """comparison.json."""
        if not flip.is_flip_available():
            self._note(flip.MISSING_NOTE)
        return {
            **make_head(self._options, self._scene),
            "view_layer": self._view_layer.name,
            "measures": {info.id: {"unit": info.unit, "meaning": info.help} for info in MEASURES},
            "frames": self._frames,
            "records": self._records,
            "temporal_measures": {info.id: {"unit": info.unit, "meaning": info.help} for info in TEMPORAL_MEASURES},
            "temporal": self._temporal,
            "notes": self._notes,
        }

    def make_page(self, document: dict[str, Any]) -> str:
        width, height = self._frames[0]["resolution"]
        frames = [record["frame"] for record in self._frames]
        return build_page(
            f"Shadow layers of {document['file'] or document['scene']}",
            {
                "Scene": document["scene"],
                "Camera": document["camera"],
                "Frames": f"{frames[0]}" if len(frames) == 1 else f"{frames[0]} to {frames[-1]}",
                "Pixels": f"{width} x {height}",
                "Triangles": f"{self._frames[0]['triangles']:,}",
                "F12 with all layers": f"{self._frames[-1]['render_ms']:.0f} ms",
                "Blender": document["blender"],
                "GL": document["gl_renderer"],
                "Revision": document["revision"],
            },
            self._lights,
            self._notes,
            self._temporal,
        )
