# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport in Rendered mode: the Combined picture, rendered beside Blender and drawn when it is there.

Blender's data is read in `sync` and `draw` only (main thread). A worker thread renders plain snapshots, always the last
one asked for: first one sample, then, if nothing changed meanwhile, all of them. A timer on the main thread asks for a
redraw when a picture is ready. Drawing goes through the `gpu` module, whatever Blender's back end is.
"""

from __future__ import annotations

import threading
import traceback
import weakref
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np

from . import bridge, picture, preferences, scene_export
from .camera_export import camera_from_view
from .snapshot import SceneSnapshot

_POLL_S = 0.02
_open: weakref.WeakSet = weakref.WeakSet()


def close_all() -> None:
    """Ends the workers of all viewports."""
    for view in list(_open):
        view.close()


def is_busy() -> bool:
    """Whether any viewport waits for a picture that is being rendered, or has one that isn't drawn yet."""
    return any(view.is_busy() for view in _open)


@dataclass
class _Picture:
    """A finished picture: RGBA float32 (h, w, 4), linear, premultiplied; or why there is none."""

    pixels: np.ndarray | None = None
    error: str | None = None


class _Worker:
    """Renders the newest snapshot it was given; older ones are dropped or cancelled."""

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._wanted: tuple[SceneSnapshot, preferences.SessionSettings] | None = None
        self._token: bridge.CancelToken | None = None
        self._finished: _Picture | None = None
        self._closing = False
        self._thread = threading.Thread(target=self._work, name="shadow-layers-viewport", daemon=True)
        self._thread.start()

    def submit(self, snapshot: SceneSnapshot, settings: preferences.SessionSettings) -> None:
        """Asks for a picture. Returns at once."""
        with self._condition:
            self._wanted = (snapshot, settings)
            if self._token is not None:
                self._token.cancel()
            self._condition.notify()

    def take(self) -> _Picture | None:
        """The picture that was finished since the last call, if any."""
        with self._condition:
            taken, self._finished = self._finished, None
            return taken

    def has_picture(self) -> bool:
        return self._finished is not None

    def is_busy(self) -> bool:
        return self._wanted is not None or self._token is not None

    def close(self) -> None:
        """Ends the thread; a running render is cancelled."""
        with self._condition:
            self._closing = True
            self._condition.notify()
        while self._thread.is_alive():
            token = self._token
            if token is not None:
                token.cancel()
            self._thread.join(_POLL_S)

    def _work(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._closing or self._wanted is not None)
                if self._closing:
                    return
                (snapshot, settings), self._wanted = self._wanted, None
                self._token = token = bridge.CancelToken()
            for samples in sorted({1, snapshot.render.samples}):
                made = self._render(snapshot, settings, samples, token)
                with self._condition:
                    if made is None or self._closing or token.cancelled:
                        break
                    self._finished = made
                    if made.error is not None:
                        break
            with self._condition:
                self._token = None

    @staticmethod
    def _render(snapshot: SceneSnapshot, settings: Any, samples: int, token: bridge.CancelToken) -> _Picture | None:
        one = replace(snapshot, render=replace(snapshot.render, samples=samples))
        try:
            done = bridge.render_snapshot(
                one, on_layer=lambda _layer: None, backend=settings.backend, threads=settings.threads, token=token
            )
        except bridge.RenderCancelled:
            return None
        except bridge.ShadowLayersError as error:
            return _Picture(error=str(error))
        except Exception as error:  # the thread must live on, and nobody else would see it
            traceback.print_exc()
            return _Picture(error=f"internal error, please report it with the scene: {error!r}")
        return _Picture(pixels=np.ascontiguousarray(done.combined, np.float32))


class Viewport:
    """What one viewport's engine shows."""

    def __init__(self, engine: Any) -> None:
        self._engine = weakref.ref(engine)
        self._exporter = scene_export.SceneExporter()
        self._scene: SceneSnapshot | None = None  # with the camera of the last request
        self._settings = preferences.SessionSettings()
        self._asked: tuple | None = None
        self._worker: _Worker | None = None
        self._texture: Any = None
        self._status = ""
        _open.add(self)

    def close(self) -> None:
        """Ends the worker. The viewport can be used again; it then starts a new one."""
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.close()
        self._asked, self._texture = None, None

    def is_busy(self) -> bool:
        """Whether what is shown is not yet the last picture asked for."""
        return self._worker is not None and (self._worker.is_busy() or self._worker.has_picture())

    def sync(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Reads the scene; the next draw asks for a picture of it."""
        self._asked = None
        try:
            self._settings = preferences.session_settings(depsgraph.scene_eval)
            camera, render = self._view(context, depsgraph)
            same = self._scene is not None and scene_export.only_moves(depsgraph)
            exported = self._exporter.export(depsgraph, camera, render, space=context.space_data, same_meshes=same)
            self._scene = _one_technique_per_light(exported)
            self._set_status("")
        except bridge.ShadowLayersError as error:
            self._scene = None
            self._set_status(str(error))

    def draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Draws the last finished picture over the region, and asks for another if the view changed."""
        if self._scene is None and not self._status:
            self.sync(context, depsgraph)
        if self._scene is not None:
            self._request(context, depsgraph)
        taken = self._worker.take() if self._worker is not None else None
        if taken is not None:
            self._set_status(taken.error or "")
            if taken.pixels is not None:
                self._texture = _upload(taken.pixels)
        if self._texture is not None:
            _draw_over(context.region, self._texture, self._engine(), depsgraph.scene)

    def _request(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        camera, render = self._view(context, depsgraph)
        asked = (camera.window, camera.clip_start, camera.clip_end, camera.world_from_camera.tobytes(), render)
        if asked == self._asked:
            return
        self._asked = asked
        self._scene = replace(self._scene, camera=camera, render=render)
        if self._worker is None:
            self._worker = _Worker()
        self._worker.submit(self._scene, self._settings)
        if not bpy.app.timers.is_registered(self._poll):
            bpy.app.timers.register(self._poll, first_interval=_POLL_S)

    def _view(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> tuple:
        region, view = context.region, context.region_data
        space = context.space_data
        clip = space
        if view.view_perspective == "CAMERA" and space.camera is not None:
            clip = space.camera.data
        camera = camera_from_view(
            view.view_matrix,
            view.window_matrix,
            float(getattr(clip, "clip_start", space.clip_start)),
            float(getattr(clip, "clip_end", space.clip_end)),
        )
        width, height = max(region.width, 1), max(region.height, 1)
        return camera, picture.render_settings(depsgraph.scene_eval, width, height, (0, 0, width, height))

    def _poll(self) -> float | None:
        """Timer on the main thread: redraws when a picture is ready, ends when nothing is on its way."""
        worker, engine = self._worker, self._engine()
        if worker is None or engine is None:
            return None
        try:
            if worker.has_picture():
                engine.tag_redraw()
        except ReferenceError:  # Blender has freed the engine
            self.close()
            return None
        return _POLL_S if self.is_busy() else None

    def _set_status(self, text: str) -> None:
        if text == self._status:
            return
        self._status = text
        engine = self._engine()
        if engine is not None:
            engine.update_stats("Shadow Layers" if text else "", text)
        if text:
            print(f"Shadow Layers: viewport: {text}", flush=True)


def _one_technique_per_light(snapshot: SceneSnapshot) -> SceneSnapshot:
    """The picture shows each light once: by the first of its techniques."""
    first: dict[int, Any] = {}
    for job in snapshot.jobs:
        first.setdefault(job.light, job)
    return replace(snapshot, jobs=list(first.values()))


def _upload(pixels: np.ndarray) -> Any:
    import gpu

    height, width = pixels.shape[:2]
    data = gpu.types.Buffer("FLOAT", width * height * 4, pixels.ravel())
    return gpu.types.GPUTexture((width, height), format="RGBA32F", data=data)


def _draw_over(region: Any, texture: Any, engine: Any, scene: Any) -> None:
    import gpu
    from gpu_extras.presets import draw_texture_2d

    gpu.state.blend_set("ALPHA_PREMULT")
    engine.bind_display_space_shader(scene)
    draw_texture_2d(texture, (0, 0), region.width, region.height)
    engine.unbind_display_space_shader()
    gpu.state.blend_set("NONE")
