# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The native core. Arrays in: C-contiguous NumPy of the dtype named (kept, not copied). Arrays out: float32, row 0 at
the bottom. Matrices are row-major (NumPy's [row][column]), float64. Errors name the culprit and the remedy."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

__version__: str
__revision__: str

class Error(RuntimeError): ...
class InputError(Error): ...
class ContextError(Error): ...
class ShaderError(Error): ...
class DriverError(Error): ...
class Cancelled(Error): ...

class ParameterInfo(TypedDict):
    id: str
    label: str
    type: str  # "bool" | "int" | "float" | "enum"
    default: bool | int | float | str
    min: float
    max: float
    step: float
    unit: str
    help: str
    items: list[dict[str, str]]  # id, label, help; enum only
    shared: bool

class OutputInfo(TypedDict):
    id: str
    label: str
    channels: int
    help: str

class TechniqueInfo(TypedDict):
    id: str
    label: str
    summary: str
    reference: str
    meshes: str  # "any" | "mesh_edges": refined at meshes' edges, not where surfaces cut each other | "closed"
    light_size: str  # "ignored" | "followed", with all parameters at their defaults
    alpha_cutouts: bool  # False: holes that a material's alpha cuts count as opaque
    restrictions: list[str]  # what these leave out, a sentence each
    limits: str  # one sentence: when it fails
    lights: list[str]  # "SUN" | "SPOT" | "POINT" | "AREA"
    parameters: list[ParameterInfo]
    outputs: list[OutputInfo]
    truth: str  # "hard" | "filtered" | "soft" | "pixel", with all parameters at their defaults
    test_only: bool

class TruthInfo(TypedDict):
    kind: str  # "hard" | "filtered" | "soft" | "pixel"
    footprint_texels: float  # filtered: side of the square that is averaged over, in the plane of a view's map
    footprint_world: float  # filtered: if not 0, side of the square in scene units on the receiver's plane

def techniques() -> list[TechniqueInfo]: ...
def resolve_parameters(technique: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """Defaults filled in and values checked; InputError names technique, parameter, value and range."""

def get_truth(technique: str, given: Mapping[str, Any]) -> TruthInfo:
    """Which exact picture a layer with these parameters stands for. InputError as of resolve_parameters."""

INSTANCE_CAMERA: int
INSTANCE_SHADOW: int
INSTANCE_HOLDOUT: int

class Scene:
    """Filled once, then given to any number of renders; from then on it takes no more (InputError)."""
    def __init__(self) -> None: ...
    def add_mesh(self, name: str, positions: NDArray[np.float32], triangles: NDArray[np.uint32]) -> int:
        """positions (n, 3) object space; triangles (m, 3). Returns the mesh's index. Both arrays are kept alive and
        made read-only; TypeError for no array, InputError for another dtype, shape, byte order or layout."""
    def set_instances(
        self,
        mesh: NDArray[np.uint32],
        world_from_object: NDArray[np.float64],
        flags: NDArray[np.uint32],
        receiver_group: NDArray[np.uint8] | None = None,
        blocker_group: NDArray[np.uint8] | None = None,
    ) -> None:
        """All instances at once: (n,), (n, 4, 4), (n,), (n,), (n,)."""
    def add_light(
        self,
        name: str,
        kind: str,  # "SUN" | "SPOT" | "POINT" | "AREA"
        world_from_light: NDArray[np.float64],
        *,
        color: Sequence[float] = (1, 1, 1),
        energy: float = 1.0,
        radius: float = 0.0,
        sun_angle: float = 0.0,
        spot_angle: float = 0.785398,
        spot_blend: float = 0.15,
        area_size: Sequence[float] = (1, 1),
        area_round: bool = False,
        casts_shadow: bool = True,
        receiver_set: int = 0xFFFFFFFFFFFFFFFF,
        blocker_set: int = 0xFFFFFFFFFFFFFFFF,
        spot_scale: Sequence[float] = (1, 1),
    ) -> int: ...
    @property
    def triangle_count(self) -> int:
        """Over all instances."""

class Camera:
    def __init__(
        self,
        *,
        perspective: bool,
        window: Sequence[float],  # left, right, bottom, top at view depth 1, or in scene units if orthographic
        clip_start: float,
        clip_end: float,
        world_from_camera: NDArray[np.float64],
    ) -> None: ...

class Layer:
    job: int
    light: int
    technique: str
    parameters: dict[str, Any]
    channels: dict[str, NDArray[np.float32]]  # (h, w) or (h, w, c), of the region
    views: list[dict[str, Any]]  # MapView of request.h; view_from_world is (4, 4) float64
    times: list[dict[str, float | str]]  # stage, cpu_ms, gl_ms (-1: no GL)
    counters: dict[str, int]
    total_ms: float

class FrameResult:
    coverage: NDArray[np.float32]  # (h, w)
    combined: NDArray[np.float32] | None  # (h, w, 4), linear, premultiplied
    aux: dict[str, NDArray[np.float32] | NDArray[np.int64]]  # see request.h; "ids" are whole numbers
    camera_position: tuple[float, float, float]
    warnings: list[str]
    times: list[dict[str, float | str]]
    counters: dict[str, int]
    total_ms: float
    layers: list[Layer]  # empty if on_layer was given

class Session:
    """One GL context on a private thread. Renders are worked one at a time; the GIL is released meanwhile.
    After close() everything but close() and cancel() raises Error. Open sessions are closed when the interpreter
    ends."""
    def __init__(
        self,
        *,
        backend: str = "auto",
        threads: int = 0,
        shader_dir: str,
        gpu_cache_bytes: int = 1 << 30,  # meshes and stage results kept between frames
        host_cache_bytes: int = 512 << 20,  # what is derived from meshes, kept between frames
        debug: bool = False,
    ) -> None: ...
    info: dict[str, Any]  # backend, gl_version, gl_renderer, gl_vendor, threads, max_texture_size, software
    def render(
        self,
        scene: Scene,
        camera: Camera,
        jobs: Sequence[tuple[int, str, Mapping[str, Any]]],  # light index, technique id, parameters
        *,
        width: int,
        height: int,
        region: tuple[int, int, int, int] | None = None,  # x, y, width, height; origin lower left
        samples: int = 1,
        filter: str = "BLACKMAN_HARRIS",  # "BOX" | "GAUSSIAN" | "BLACKMAN_HARRIS"
        filter_width: float = 1.5,
        combined: bool = True,
        aux: Sequence[str] = (),
        on_layer: Callable[[Layer], None] | None = None,
        on_progress: Callable[[float, str], None] | None = None,
    ) -> FrameResult:
        """Both callbacks run on this thread; what they raise, and Ctrl-C, ends the render and is raised from here."""
    def cancel(self) -> None:
        """From any thread; the running render raises Cancelled within 300 ms."""
    host_bytes: int  # held after the last render: mesh data and frames on the host
    gpu_bytes: int  # the same for all that lies on the GL
    def close(self) -> None: ...
    def __enter__(self) -> Session: ...
    def __exit__(self, *exc: object) -> None: ...
