# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Taking what the engine renders, with everything that the passes can't hold. No bpy.

    with engine.capture(aux=("position", "normal", "ids")) as captured:
        bpy.ops.render.render()
    for frame in captured.frames: ...

Each rendered frame and view layer appends one CapturedFrame. The pictures are the core's own arrays (float32, row 0 at
the bottom, size of the region); passes are written as always. `captured.errors` holds the texts that the engine
reported; after one, the frame is missing. Captures nest: each gets every frame.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .snapshot import Job, SceneSnapshot


@dataclass
class CapturedLayer:
    """One light worked by one technique. `channels` maps output ids ("visibility", ...) to (h, w) or (h, w, c)
    pictures; `pass_names` the same ids to the names of the render passes that hold them."""

    job_index: int
    job: Job
    light: str
    technique: str
    parameters: dict[str, Any]  # resolved by the core
    channels: dict[str, np.ndarray]
    pass_names: dict[str, str]
    times: list[dict[str, float | str]]
    counters: dict[str, int]
    total_ms: float
    views: list[dict[str, Any]] = field(default_factory=list)  # of its maps: MapView in request.h


@dataclass
class CapturedFrame:
    """One frame of one view layer. `coverage` (h, w), `combined` (h, w, 4) or None, `aux` as asked for. `layers` are in
    job order. `info` holds versions, back end and GL names; `addon_ms` the add-on's own times ("export", "write")."""

    frame: int
    view_layer: str
    snapshot: SceneSnapshot
    info: dict[str, Any] = field(default_factory=dict)
    layers: list[CapturedLayer] = field(default_factory=list)
    coverage: np.ndarray | None = None
    combined: np.ndarray | None = None
    aux: dict[str, np.ndarray] = field(default_factory=dict)
    camera_position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    warnings: list[str] = field(default_factory=list)
    times: list[dict[str, float | str]] = field(default_factory=list)
    counters: dict[str, int] = field(default_factory=dict)
    total_ms: float = 0.0
    addon_ms: dict[str, float] = field(default_factory=dict)


@dataclass
class Captured:
    """What a capture collects."""

    aux: tuple[str, ...] = ()
    frames: list[CapturedFrame] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)


_active: list[Captured] = []


@contextlib.contextmanager
def capture(aux: Sequence[str] = ()) -> Iterator[Captured]:
    """Collects what is rendered inside the `with` block; see the module's text. `aux`: "position", "normal", "ids",
    "depth" (of the first sample). "ids" are int64: the instance's and the triangle's index; -1, -1: nothing is seen."""
    captured = Captured(tuple(aux))
    _active.append(captured)
    try:
        yield captured
    finally:
        _active.remove(captured)


def wanted_aux() -> tuple[str, ...]:
    """The auxiliary pictures that any running capture asks for."""
    return tuple(dict.fromkeys(name for captured in _active for name in captured.aux))


def is_active() -> bool:
    return bool(_active)


def add_frame(frame: CapturedFrame) -> None:
    """Called by the engine with a frame that was rendered to its end."""
    for captured in _active:
        captured.frames.append(frame)


def add_error(text: str) -> None:
    """Called by the engine with what it reports."""
    for captured in _active:
        captured.errors.append(text)
