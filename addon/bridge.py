# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The only door to the native core: finds and loads `shadow_core`, keeps the process's one session, renders snapshots.

Nothing here knows bpy. All functions may be called from any thread; renders are worked one at a time by the session.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib.machinery
import importlib.util
import os
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from .snapshot import SceneSnapshot

MODULE_NAME = "shadow_core"
ENV_NATIVE = "SHADOW_LAYERS_NATIVE"
ENV_SHADERS = "SHADOW_LAYERS_SHADERS"
BACKENDS = ("auto", "osmesa", "egl")


class ShadowLayersError(RuntimeError):
    """Something that can't be rendered; the text names the culprit and the remedy, and is fit for a report."""


class ModuleMissing(ShadowLayersError):
    """The native module can't be found or loaded."""


class RenderCancelled(ShadowLayersError):
    """The render was cancelled; not a failure."""


class _State:
    """What the process holds: the module, the descriptors, the session and the settings it was made with."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.module: ModuleType | None = None
        self.module_error: str | None = None
        self.techniques: list[dict[str, Any]] | None = None
        self.session: Any = None
        self.session_settings: tuple[str, int] | None = None
        self.render_lock = threading.Lock()  # held by the render that runs, so that a token cancels its own only
        self.running: CancelToken | None = None


_state = _State()
_HERE = Path(__file__).resolve().parent


def _native_folders() -> list[Path]:
    folders = [Path(os.environ[ENV_NATIVE])] if os.environ.get(ENV_NATIVE) else []
    return [*folders, _HERE / "native", _HERE.parent / "build" / "release" / "python"]


def _find_module_file() -> Path:
    for folder in _native_folders():
        for suffix in importlib.machinery.EXTENSION_SUFFIXES:
            file = folder / (MODULE_NAME + suffix)
            if file.is_file():
                return file
    places = ", ".join(f'"{folder}"' for folder in _native_folders())
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    raise ModuleMissing(
        f"the native module {MODULE_NAME} for Python {version} is in none of {places}; install the add-on from its "
        f"package, or build it (cmake --preset release && cmake --build --preset release), or set {ENV_NATIVE}"
    )


def core() -> ModuleType:
    """The native module, loaded on first use. Raises ModuleMissing naming the places tried and the remedy."""
    with _state.lock:
        if _state.module is not None:
            return _state.module
        if MODULE_NAME in sys.modules:  # loaded by someone else in this process; a second copy would clash
            _state.module = sys.modules[MODULE_NAME]
            return _state.module
        file = _find_module_file()
        loader = importlib.machinery.ExtensionFileLoader(MODULE_NAME, str(file))
        spec = importlib.util.spec_from_file_location(MODULE_NAME, file, loader=loader)
        try:
            module = importlib.util.module_from_spec(spec)
            loader.exec_module(module)
        except ImportError as error:
            text = f'the native module "{file}" does not load: {error}; install or build it again'
            raise ModuleMissing(text) from error
        sys.modules[MODULE_NAME] = module
        _state.module = module
        return module


def available() -> str | None:
    """None if the native module loads, else the reason with its remedy. Cheap after the first call."""
    with _state.lock:
        if _state.module is None and _state.module_error is None:
            try:
                core()
            except ModuleMissing as error:
                _state.module_error = str(error)
        return None if _state.module is not None else _state.module_error


def techniques(*, test_only: bool = False) -> list[dict[str, Any]]:
    """Descriptors (TechniqueInfo) in menu order, without those for tests unless asked for. Empty without the module."""
    with _state.lock:
        if _state.techniques is None:
            if available() is not None:
                return []
            _state.techniques = list(core().techniques())
        return [info for info in _state.techniques if test_only or not info["test_only"]]


def find_technique(technique_id: str) -> dict[str, Any]:
    """The descriptor of that id, test-only ones included. ShadowLayersError lists the known ids."""
    for info in techniques(test_only=True):
        if info["id"] == technique_id:
            return info
    reason = available()
    if reason is not None:
        raise ModuleMissing(reason)
    known = ", ".join(info["id"] for info in techniques())
    raise ShadowLayersError(f'there is no technique "{technique_id}"; the techniques are: {known}')


def resolve_parameters(technique_id: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """Defaults filled in and values checked. ShadowLayersError names technique, parameter, value and range."""
    with _ErrorsTranslated():
        return dict(core().resolve_parameters(technique_id, dict(given)))


def get_truth(technique_id: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """What a layer with these parameters approximates: "kind" ("hard", "filtered", "soft", "pixel"), and the side of
    a filtered truth's square: "footprint_world" in scene units or, if that is 0, "footprint_texels"."""
    with _ErrorsTranslated():
        return dict(core().get_truth(technique_id, dict(given)))


def shader_folder() -> Path:
    """The folder of the shaders: the environment's, the package's or the source tree's."""
    if os.environ.get(ENV_SHADERS):
        return Path(os.environ[ENV_SHADERS])
    folders = [_HERE / "shaders", _HERE.parent / "shaders"]
    for folder in folders:
        if (folder / "shared").is_dir():
            return folder
    places = ", ".join(f'"{folder}"' for folder in folders)
    raise ShadowLayersError(f"the shader folder is in none of {places}; install the add-on from its package again")


def session(backend: str = "auto", threads: int = 0) -> Any:
    """The process's session, made on first use and made anew when backend or threads differ from last time.
    Raises ModuleMissing, or ShadowLayersError with what each GL back end said."""
    with _state.lock:
        wanted = (backend, int(threads))
        if _state.session is not None and _state.session_settings != wanted:
            shutdown()
        if _state.session is None:
            module = core()
            with _ErrorsTranslated():
                _state.session = module.Session(backend=backend, threads=int(threads), shader_dir=str(shader_folder()))
            _state.session_settings = wanted
        return _state.session


def session_info() -> dict[str, Any]:
    """Versions, and back end and GL names of the running session ({} of those without one)."""
    module = core()
    with _state.lock:
        info = dict(_state.session.info) if _state.session is not None else {}
    return {"version": module.__version__, "revision": module.__revision__, **info}


class CancelToken:
    """Cancels one render and no other, before it has begun or while it runs. May be called from any thread; call it
    until the render has ended, for a call in the instant of its start may be missed."""

    def __init__(self) -> None:
        self.cancelled = False

    def cancel(self) -> None:
        """The render given this token raises RenderCancelled within 300 ms."""
        self.cancelled = True
        running = _state.session
        if _state.running is self and running is not None:
            running.cancel()


def shutdown() -> None:
    """Closes the session: ends its thread and frees its GL context. The next render makes a new one."""
    with _state.lock:
        closing, _state.session, _state.session_settings = _state.session, None, None
    if closing is not None:
        closing.close()


atexit.register(shutdown)


def build_scene(snapshot: SceneSnapshot) -> Any:
    """A shadow_core.Scene that shares the snapshot's arrays (nothing is copied; don't write to them afterwards)."""
    with _ErrorsTranslated():
        scene = core().Scene()
        for mesh in snapshot.meshes:
            scene.add_mesh(mesh.name, mesh.positions, mesh.triangles)
        scene.set_instances(
            snapshot.instance_mesh,
            snapshot.instance_matrix,
            snapshot.instance_flags,
            snapshot.instance_receiver_group,
            snapshot.instance_blocker_group,
        )
        for light in snapshot.lights:
            scene.add_light(
                light.name,
                light.kind,
                np.ascontiguousarray(light.world_from_light, np.float64),
                color=light.color,
                energy=light.energy,
                radius=light.radius,
                sun_angle=light.sun_angle,
                spot_angle=light.spot_angle,
                spot_blend=light.spot_blend,
                spot_scale=light.spot_scale,
                area_size=light.area_size,
                area_round=light.area_round,
                casts_shadow=light.casts_shadow,
                receiver_set=light.receiver_set,
                blocker_set=light.blocker_set,
            )
        return scene


def build_camera(snapshot: SceneSnapshot) -> Any:
    """A shadow_core.Camera."""
    camera = snapshot.camera
    with _ErrorsTranslated():
        return core().Camera(
            perspective=bool(camera.perspective),
            window=tuple(camera.window),
            clip_start=camera.clip_start,
            clip_end=camera.clip_end,
            world_from_camera=np.ascontiguousarray(camera.world_from_camera, np.float64),
        )


def render_snapshot(
    snapshot: SceneSnapshot,
    *,
    aux: Sequence[str] = (),
    combined: bool = True,
    on_layer: Callable[[Any], None] | None = None,
    on_progress: Callable[[float, str], None] | None = None,
    backend: str = "auto",
    threads: int = 0,
    token: CancelToken | None = None,
) -> Any:
    """Renders one frame on the process's session and returns the core's FrameResult (its pictures cover the region).

    Blocks with the GIL released; the callbacks run on the calling thread. With `on_layer` the layers go there, one by
    one, and the result's own list stays empty. Raises RenderCancelled after token.cancel(), else ShadowLayersError.
    """
    settings = snapshot.render
    token = token or CancelToken()
    with _state.render_lock, _ErrorsTranslated():
        running = session(backend, threads)
        scene, camera = build_scene(snapshot), build_camera(snapshot)
        jobs = [(job.light, job.technique, dict(job.parameters)) for job in snapshot.jobs]
        if token.cancelled:
            raise RenderCancelled("the render was cancelled")
        _state.running = token
        try:
            return running.render(
                scene,
                camera,
                jobs,
                width=settings.width,
                height=settings.height,
                region=tuple(settings.region),
                samples=settings.samples,
                filter=settings.filter,
                filter_width=settings.filter_width,
                combined=combined,
                aux=tuple(aux),
                on_layer=on_layer,
                on_progress=on_progress,
            )
        finally:
            _state.running = None


class _ErrorsTranslated(contextlib.AbstractContextManager):
    """Turns the core's exceptions into this module's, so that callers need no native import."""

    def __exit__(self, _kind: Any, error: BaseException | None, _trace: Any) -> None:
        module = _state.module
        if error is None or module is None or not isinstance(error, module.Error):
            return
        if isinstance(error, module.Cancelled):
            raise RenderCancelled(str(error)) from error
        raise ShadowLayersError(str(error)) from error
