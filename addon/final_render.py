# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A final render (F12, -f, -a) of one view layer: export, run the core, fill the passes.

Whatever goes wrong, a whole result is published first and the error reported after: Blender's EXR writer crashes on a
layer that was never published, and a report with ERROR is what makes `-f` write no file and end with exit code 1.
"""

from __future__ import annotations

import queue
import threading
import time
from typing import Any

import bpy
import numpy as np

from . import bridge, capture, names, passes, preferences
from .names import COVERAGE_PASS
from .scene_export import SceneExporter, export_for_render
from .snapshot import SceneSnapshot

_POLL_S = 0.03  # how often Esc is looked for
_STATS_S = 0.25  # how often the status line changes; in the background each change is a line of the log
_exporters: dict[tuple[str, str], SceneExporter] = {}
_logged_in_animation: set[str] = set()


def forget() -> None:
    """Lets go of the arrays kept for the next frame."""
    _exporters.clear()


def _exporter(scene: Any, view_layer: Any) -> SceneExporter:
    """The exporter of a scene and view layer, kept so that unchanged meshes keep their arrays over frames."""
    key = (scene.name_full, view_layer.name)
    if key not in _exporters and len(_exporters) >= 8:
        _exporters.clear()
    return _exporters.setdefault(key, SceneExporter())


class FinalRender:
    """Made in the engine's `update` (data locked), run in its `render`."""

    def __init__(self, engine: Any, depsgraph: Any) -> None:
        self._engine = engine
        self._view_layer = depsgraph.view_layer_eval.name
        self._snapshot: SceneSnapshot | None = None
        self._error: str | None = None
        self._addon_ms: dict[str, float] = {}
        start = time.perf_counter()
        try:
            self._check(depsgraph.scene_eval)
            self._settings = preferences.session_settings(depsgraph.scene_eval)
            camera = engine.camera_override or depsgraph.scene_eval.camera
            exporter = _exporter(depsgraph.scene, depsgraph.view_layer)
            self._snapshot = export_for_render(exporter, depsgraph, camera)
            self._error = self._nothing_to_do(depsgraph.scene, depsgraph.view_layer_eval)
        except bridge.ShadowLayersError as error:
            self._error = str(error)
        self._addon_ms["export"] = (time.perf_counter() - start) * 1e3

    @staticmethod
    def _check(scene: Any) -> None:
        """Refuses what can't be rendered, before any work."""
        reason = bridge.available()
        if reason is not None:
            raise bridge.ModuleMissing(reason)
        if scene.render.use_multiview:
            raise bridge.ShadowLayersError(
                "stereo is not supported; switch Properties > Output > Stereoscopy off, or render each camera by itself"
            )

    def _nothing_to_do(self, scene: Any, view_layer: Any) -> str | None:
        """The error if no view layer would get a shadow layer; a note if only this one gets none."""
        if self._snapshot.jobs or not view_layer.shadow_layers.enabled:
            return None
        place = f'view layer "{view_layer.name}"'
        if not self._snapshot.lights:
            text = f"{place} has no light; add a sun, spot, point or area light that is visible in renders"
        else:
            text = (
                f"{place}: no technique is chosen for any light; choose one in Properties > Render > Shadow Layers, "
                "or set a light's Shadow Layers to As Scene"
            )
        if sum(layer.use for layer in scene.view_layers) > 1:
            self._snapshot.warnings.append(text)
            return None
        return text

    def run(self) -> None:
        """Renders and publishes. Reports errors; raises nothing."""
        engine = self._engine
        width, height = engine.resolution_x, engine.resolution_y
        if self._error is None:
            passes.add_all(engine, passes.plan(self._snapshot), self._view_layer)
        result = engine.begin_result(0, 0, width, height, layer=self._view_layer)
        problem, frame = self._error, None
        try:
            if problem is None:
                frame = self._render_into(result)
        except bridge.RenderCancelled:
            pass
        except bridge.ShadowLayersError as error:
            problem = str(error)
        except Exception as error:
            problem = f"internal error, please report it with the scene: {error!r}"
            raise
        finally:
            engine.end_result(result)
            if problem is not None:
                capture.add_error(problem)
                engine.report({"ERROR"}, f"Shadow Layers: {problem}")
        if frame is not None:
            self._finish(frame)

    def _render_into(self, result: Any) -> capture.CapturedFrame:
        snapshot = self._snapshot
        planned = passes.plan(snapshot)
        target = result.layers[0].passes
        region = snapshot.render.region
        if (result.resolution_x, result.resolution_y) != region[2:]:
            raise bridge.ShadowLayersError(
                f"the border is {region[2]} x {region[3]} pixels, but Blender wants "
                f"{result.resolution_x} x {result.resolution_y}; please report it with the border's values"
            )
        frame = capture.CapturedFrame(
            snapshot.source["frame"], self._view_layer, snapshot, addon_ms=self._addon_ms, warnings=snapshot.warnings[:]
        )
        by_job: dict[int, list] = {}
        for item in planned:
            by_job.setdefault(item.job, []).append(item)
        self._addon_ms["write"] = 0.0

        def on_layer(layer: Any) -> None:
            start = time.perf_counter()
            channels = layer.channels
            for item in by_job[layer.job]:
                passes.write(target, item.name, channels[item.output])
            self._addon_ms["write"] += (time.perf_counter() - start) * 1e3
            if capture.is_active():
                frame.layers.append(self._captured(layer, by_job[layer.job]))

        done = self._run_core(on_layer)
        passes.write(target, "Combined", done.combined)
        passes.write(target, COVERAGE_PASS, done.coverage)
        self._light_up_orphans(target, planned)
        frame.coverage, frame.combined, frame.aux = done.coverage, done.combined, dict(done.aux)
        frame.camera_position = tuple(done.camera_position)
        frame.warnings += list(done.warnings) + self._cut_name_warnings(planned)
        frame.times, frame.counters, frame.total_ms = list(done.times), dict(done.counters), done.total_ms
        frame.info = bridge.session_info()
        return frame

    def _captured(self, layer: Any, planned: list) -> capture.CapturedLayer:
        job = self._snapshot.jobs[layer.job]
        return capture.CapturedLayer(
            job_index=layer.job,
            job=job,
            light=self._snapshot.lights[job.light].name,
            technique=job.technique,
            parameters=dict(layer.parameters),
            channels=dict(layer.channels),
            pass_names={item.output: item.name for item in planned},
            times=list(layer.times),
            counters=dict(layer.counters),
            total_ms=layer.total_ms,
            views=list(layer.views),
        )

    def _cut_name_warnings(self, planned: list) -> list[str]:
        """Blender before 5.0 cuts long channel names when it writes EXR, and then loses passes without a word."""
        cut = [item.name for item in planned if names.is_cut_in_exr(self._view_layer, item.name)]
        if not cut or bpy.app.version >= (5, 0, 0):
            return []
        return [
            f'view layer "{self._view_layer}": its name is too long for the channels of "{cut[0]}" in an EXR file, '
            f"which Blender cuts to {names.EXR_NAME_BYTES} bytes; give the view layer a shorter name"
        ]

    @staticmethod
    def _light_up_orphans(target: Any, planned: list) -> None:
        """Announced passes whose light isn't in the evaluated scene: lit, not a black layer."""
        known = {item.name for item in planned} | {"Combined", COVERAGE_PASS}
        for item in target:
            if item.name not in known and item.name.startswith("Shadow ") and item.channels == 1:
                passes.write(target, item.name, np.ones(len(item.rect), np.float32))

    def _run_core(self, on_layer: Any) -> Any:
        """Runs the core on a thread of its own, while this one looks for Esc and writes layers as they come: Blender
        is touched from the render's own thread only."""
        events: queue.SimpleQueue = queue.SimpleQueue()
        token = bridge.CancelToken()

        def work() -> None:
            try:
                events.put(("done", bridge.render_snapshot(
                    self._snapshot,
                    aux=capture.wanted_aux(),
                    on_layer=lambda layer: events.put(("layer", layer)),
                    on_progress=lambda part, text: events.put(("progress", (part, text))),
                    backend=self._settings.backend,
                    threads=self._settings.threads,
                    token=token,
                )))  # fmt: skip
            except BaseException as error:  # handed over to the render's thread, which raises it
                events.put(("failed", error))

        worker = threading.Thread(target=work, name="shadow-layers-render", daemon=True)
        worker.start()
        try:
            return self._follow(events, on_layer, token)
        finally:
            while worker.is_alive():  # only after an error here: a finished render's thread is at its end
                token.cancel()
                worker.join(_POLL_S)

    def _follow(self, events: queue.SimpleQueue, on_layer: Any, token: bridge.CancelToken) -> Any:
        engine, shown = self._engine, 0.0
        while True:
            if token.cancelled or self._stop_wanted():
                token.cancel()
            try:
                kind, value = events.get(timeout=_POLL_S)
            except queue.Empty:
                continue
            if kind == "done":
                return value
            if kind == "failed":
                raise value
            if kind == "layer" and not token.cancelled:
                on_layer(value)
            elif kind == "progress" and time.monotonic() - shown > _STATS_S:
                shown = time.monotonic()
                engine.update_progress(min(max(value[0], 0.0), 1.0))
                engine.update_stats("", f"Shadow Layers | {value[1]}")

    def _stop_wanted(self) -> bool:
        return self._engine.test_break()

    def _finish(self, frame: capture.CapturedFrame) -> None:
        """After publishing: metadata, warnings, captures."""
        engine = self._engine
        passes.stamp(engine.get_result(), self._snapshot, passes.plan(self._snapshot), frame.info)
        if not engine.is_animation:
            _logged_in_animation.clear()
        for warning in frame.warnings:
            if warning not in _logged_in_animation:
                print(f"Shadow Layers: {warning}", flush=True)
        if engine.is_animation:
            _logged_in_animation.update(frame.warnings)
        elif frame.warnings:
            more = f" (and {len(frame.warnings) - 1} more, see the log)" if len(frame.warnings) > 1 else ""
            engine.report({"WARNING"}, f"Shadow Layers: {frame.warnings[0]}{more}")
        capture.add_frame(frame)
