# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The exported scene as plain data, and its file form (docs/snapshot.md). NumPy only: no bpy, no native module.

Space conventions are those of the core: matrices are row-major float64 "world_from_x", positions are float32 object
space in scene units, pictures have row 0 at the bottom, angles are radians.
"""

from __future__ import annotations

import json
import os
import tempfile
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

FORMAT = "shadow-layers-snapshot"
VERSION = 1
ALL_GROUPS = 0xFFFFFFFFFFFFFFFF

# Bits of instance_flags, as in native/include/shadow_layers/scene.h.
INSTANCE_CAMERA = 1
INSTANCE_SHADOW = 2
INSTANCE_HOLDOUT = 4

LIGHT_KINDS = ("SUN", "SPOT", "POINT", "AREA")
PIXEL_FILTERS = ("BOX", "GAUSSIAN", "BLACKMAN_HARRIS")


class SnapshotError(ValueError):
    """A snapshot or its file is not what docs/snapshot.md says; the text names the member and the remedy."""


@dataclass
class MeshData:
    """A unique mesh: positions (n, 3) float32 in object space, triangles (m, 3) uint32."""

    name: str
    positions: np.ndarray
    triangles: np.ndarray

    @property
    def triangle_count(self) -> int:
        return len(self.triangles)


@dataclass
class LightData:
    """A light; fields as struct Light in scene.h. `area_size` is in scene units, scale already applied."""

    name: str
    kind: str
    world_from_light: np.ndarray
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    energy: float = 1.0
    radius: float = 0.0
    sun_angle: float = 0.0
    spot_angle: float = 0.785398
    spot_blend: float = 0.15
    spot_scale: tuple[float, float] = (1.0, 1.0)
    area_size: tuple[float, float] = (1.0, 1.0)
    area_round: bool = False
    casts_shadow: bool = True
    receiver_set: int = ALL_GROUPS
    blocker_set: int = ALL_GROUPS


@dataclass
class CameraData:
    """A pinhole or orthographic camera; `window` is (left, right, bottom, top) at depth 1, or in scene units if
    orthographic. `world_from_camera` (4, 4) has no scale."""

    perspective: bool
    window: tuple[float, float, float, float]
    clip_start: float
    clip_end: float
    world_from_camera: np.ndarray


@dataclass
class RenderSettings:
    """Size of the full picture, the region to render (x, y, width, height; origin lower left) and the sampling."""

    width: int
    height: int
    region: tuple[int, int, int, int]
    samples: int = 1
    filter: str = "BLACKMAN_HARRIS"
    filter_width: float = 1.5


@dataclass
class Job:
    """One light worked by one technique. `parameters` holds what differs from the technique's defaults, or all."""

    light: int
    technique: str
    parameters: dict[str, Any] = field(default_factory=dict)


@dataclass
class SceneSnapshot:
    """Everything the core needs for one frame of one view layer. Instance arrays all have length i."""

    camera: CameraData
    render: RenderSettings
    meshes: list[MeshData] = field(default_factory=list)
    instance_mesh: np.ndarray = field(default_factory=lambda: np.zeros(0, np.uint32))
    instance_matrix: np.ndarray = field(default_factory=lambda: np.zeros((0, 4, 4), np.float64))
    instance_flags: np.ndarray = field(default_factory=lambda: np.zeros(0, np.uint32))
    instance_receiver_group: np.ndarray = field(default_factory=lambda: np.zeros(0, np.uint8))
    instance_blocker_group: np.ndarray = field(default_factory=lambda: np.zeros(0, np.uint8))
    instance_names: list[str] | None = None
    lights: list[LightData] = field(default_factory=list)
    jobs: list[Job] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    source: dict[str, Any] = field(default_factory=dict)
    contents: dict[str, Any] = field(default_factory=dict)  # of scene_tally.py: what the scene holds, what is lost

    @property
    def instance_count(self) -> int:
        return len(self.instance_mesh)

    @property
    def triangle_count(self) -> int:
        """Over all instances."""
        counts = np.array([len(mesh.triangles) for mesh in self.meshes], np.int64)
        return int(counts[self.instance_mesh].sum()) if len(counts) else 0

    def validate(self) -> None:
        """Raises SnapshotError naming the member whose shape, dtype or value is wrong."""
        for k, mesh in enumerate(self.meshes):
            _expect_array(f"mesh_positions_{k}", mesh.positions, np.float32, (None, 3))
            _expect_array(f"mesh_triangles_{k}", mesh.triangles, np.uint32, (None, 3))
        n = self.instance_count
        for name, dtype, shape in _INSTANCE_MEMBERS:
            _expect_array(name, getattr(self, name), dtype, (n, *shape))
        if n and int(self.instance_mesh.max()) >= len(self.meshes):
            raise SnapshotError(
                f"instance_mesh names mesh {int(self.instance_mesh.max())}, but there are {len(self.meshes)} meshes"
            )
        if self.instance_names is not None and len(self.instance_names) != n:
            raise SnapshotError(f"{len(self.instance_names)} instance names for {n} instances; leave them all out")
        for light in self.lights:
            if light.kind not in LIGHT_KINDS:
                raise SnapshotError(f'light "{light.name}": kind "{light.kind}" is none of {", ".join(LIGHT_KINDS)}')
        for index, job in enumerate(self.jobs):
            if not 0 <= job.light < len(self.lights):
                raise SnapshotError(f"job {index} names light {job.light}, but there are {len(self.lights)} lights")
        if self.render.filter not in PIXEL_FILTERS:
            raise SnapshotError(f'render.filter "{self.render.filter}" is none of {", ".join(PIXEL_FILTERS)}')

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the .npz under its final name only when it is whole. Raises OSError, SnapshotError."""
        self.validate()
        path = Path(path)
        handle, temporary = tempfile.mkstemp(prefix=path.name + ".", suffix=".part", dir=path.parent)
        try:
            with (
                os.fdopen(handle, "wb") as stream,
                zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
            ):
                archive.writestr("snapshot.json", json.dumps(self._to_json(), ensure_ascii=False, indent=1))
                for k, mesh in enumerate(self.meshes):
                    _write_array(archive, f"mesh_positions_{k}", mesh.positions)
                    _write_array(archive, f"mesh_triangles_{k}", mesh.triangles)
                for name, _dtype, _shape in _INSTANCE_MEMBERS:
                    _write_array(archive, name, getattr(self, name))
            os.chmod(temporary, 0o644)  # mkstemp's 0600 would hide the file from others
            os.replace(temporary, path)
        except BaseException:
            Path(temporary).unlink(missing_ok=True)
            raise
        return path

    @staticmethod
    def load(path: str | os.PathLike[str]) -> SceneSnapshot:
        """Reads a snapshot file. Raises SnapshotError naming file, member and remedy; OSError if it can't be opened."""
        try:
            with zipfile.ZipFile(path) as archive:
                return _from_archive(archive)
        except (zipfile.BadZipFile, KeyError, TypeError, ValueError, EOFError) as error:
            if isinstance(error, SnapshotError):
                raise SnapshotError(f'"{path}": {error}') from error
            raise SnapshotError(f'"{path}" is not a whole snapshot file ({error}); write it again') from error

    def _to_json(self) -> dict[str, Any]:
        names = self.instance_names
        render = self.render
        return {
            "format": FORMAT,
            "version": VERSION,
            "source": self.source,
            "meshes": [{"name": mesh.name} for mesh in self.meshes],
            **({} if names is None else {"instances": [{"name": name} for name in names]}),
            "lights": [_light_to_json(light) for light in self.lights],
            "camera": {
                "perspective": bool(self.camera.perspective),
                "window": [float(v) for v in self.camera.window],
                "clip_start": float(self.camera.clip_start),
                "clip_end": float(self.camera.clip_end),
                "world_from_camera": np.asarray(self.camera.world_from_camera, np.float64).tolist(),
            },
            "render": {
                "width": int(render.width),
                "height": int(render.height),
                "region": [int(v) for v in render.region],
                "samples": int(render.samples),
                "filter": render.filter,
                "filter_width": float(render.filter_width),
            },
            "jobs": [{"light": j.light, "technique": j.technique, "parameters": j.parameters} for j in self.jobs],
            "warnings": list(self.warnings),
            "contents": self.contents,
        }


_INSTANCE_MEMBERS = (
    ("instance_mesh", np.uint32, ()),
    ("instance_matrix", np.float64, (4, 4)),
    ("instance_flags", np.uint32, ()),
    ("instance_receiver_group", np.uint8, ()),
    ("instance_blocker_group", np.uint8, ()),
)


def _expect_array(name: str, array: np.ndarray, dtype: type, shape: tuple[int | None, ...]) -> None:
    fits = array.ndim == len(shape) and all(w is None or w == g for w, g in zip(shape, array.shape, strict=True))
    if array.dtype != dtype or not fits:
        wanted = "(" + ", ".join("n" if v is None else str(v) for v in shape) + ")"
        raise SnapshotError(f"{name} must be {np.dtype(dtype).name} {wanted}, not {array.dtype.name} {array.shape}")


def _write_array(archive: zipfile.ZipFile, name: str, array: np.ndarray) -> None:
    with archive.open(name + ".npy", "w", force_zip64=True) as stream:
        np.lib.format.write_array(stream, np.ascontiguousarray(array), allow_pickle=False)


def _read_array(archive: zipfile.ZipFile, name: str, dtype: type) -> np.ndarray:
    try:
        with archive.open(name + ".npy") as stream:
            array = np.lib.format.read_array(stream, allow_pickle=False)
    except KeyError as error:
        raise SnapshotError(f"member {name}.npy is missing; write the snapshot again") from error
    if array.dtype.newbyteorder("=") != np.dtype(dtype):
        raise SnapshotError(f"member {name}.npy must be {np.dtype(dtype).name}, not {array.dtype}")
    return np.ascontiguousarray(array, dtype)


def _light_to_json(light: LightData) -> dict[str, Any]:
    return {
        "name": light.name,
        "kind": light.kind,
        "world_from_light": np.asarray(light.world_from_light, np.float64).tolist(),
        "color": [float(v) for v in light.color],
        "energy": float(light.energy),
        "radius": float(light.radius),
        "sun_angle": float(light.sun_angle),
        "spot_angle": float(light.spot_angle),
        "spot_blend": float(light.spot_blend),
        "spot_scale": [float(v) for v in light.spot_scale],
        "area_size": [float(v) for v in light.area_size],
        "area_round": bool(light.area_round),
        "casts_shadow": bool(light.casts_shadow),
        "receiver_set": f"{light.receiver_set:016x}",
        "blocker_set": f"{light.blocker_set:016x}",
    }


def _light_from_json(data: dict[str, Any]) -> LightData:
    values = dict(data)
    values["world_from_light"] = np.array(values["world_from_light"], np.float64).reshape(4, 4)
    values["color"] = tuple(values.get("color", (1.0, 1.0, 1.0)))
    values["area_size"] = tuple(values.get("area_size", (1.0, 1.0)))
    values["spot_scale"] = tuple(values.get("spot_scale", (1.0, 1.0)))
    for key in ("receiver_set", "blocker_set"):
        values[key] = int(values.get(key, "f" * 16), 16)
    return LightData(**values)


def _from_archive(archive: zipfile.ZipFile) -> SceneSnapshot:
    try:
        document = json.loads(archive.read("snapshot.json").decode("utf-8"))
    except KeyError as error:
        raise SnapshotError("member snapshot.json is missing; this is no snapshot file") from error
    if document.get("format") != FORMAT:
        raise SnapshotError(f'format is "{document.get("format")}", not "{FORMAT}"')
    if document["version"] > VERSION:
        raise SnapshotError(f"version {document['version']} is newer than version {VERSION}; update Shadow Layers")
    meshes = [
        MeshData(
            mesh["name"],
            _read_array(archive, f"mesh_positions_{k}", np.float32),
            _read_array(archive, f"mesh_triangles_{k}", np.uint32),
        )
        for k, mesh in enumerate(document["meshes"])
    ]
    camera, render = document["camera"], document["render"]
    camera["window"] = tuple(camera["window"])
    camera["world_from_camera"] = np.array(camera["world_from_camera"], np.float64).reshape(4, 4)
    render["region"] = tuple(render["region"])
    names = document.get("instances")
    snapshot = SceneSnapshot(
        camera=CameraData(**camera),
        render=RenderSettings(**render),
        meshes=meshes,
        instance_names=None if names is None else [item["name"] for item in names],
        lights=[_light_from_json(light) for light in document["lights"]],
        jobs=[Job(job["light"], job["technique"], job.get("parameters", {})) for job in document["jobs"]],
        warnings=list(document.get("warnings", [])),
        contents=dict(document.get("contents", {})),
        source=dict(document.get("source", {})),
        **{name: _read_array(archive, name, dtype) for name, dtype, _shape in _INSTANCE_MEMBERS},
    )
    snapshot.validate()
    return snapshot
