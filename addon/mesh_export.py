# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes as arrays, read by foreach_get; arrays that didn't change since the last export are kept."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .snapshot import MeshData

StoreKey = tuple[str, frozenset, int]
ReadKey = tuple[int, int, int, frozenset | None]  # address, vertices, polygons, hidden slots


@dataclass(frozen=True)
class ReadMesh:
    """What was read of a mesh: the arrays (None: nothing to draw), the triangles that it has, and those of its fully
    transparent materials; both counted by corners, not by what was read."""

    data: MeshData | None = None
    triangles: int = 0
    clear: int = 0


class MeshStore:
    """Arrays of the last export of a scene, so that a mesh that is read again with equal content keeps its arrays
    (memory isn't doubled, and the core sees the same owner). Holds NumPy data only, nothing of Blender."""

    def __init__(self) -> None:
        self._last: dict[StoreKey, MeshData] = {}
        self._current: dict[StoreKey, MeshData] = {}
        self._ordinals: Counter[tuple[str, frozenset]] = Counter()
        self._last_read: dict[ReadKey, ReadMesh] = {}
        self._read: dict[ReadKey, ReadMesh] = {}
        self._trust = False

    def begin(self, trust: bool = False) -> None:
        """Starts an export; what the one before the last held is let go. `trust`: no mesh changed since the last one,
        so a mesh at the same address is the same mesh and isn't read again."""
        if self._current:
            self._last = self._current
        self._current = {}
        self._last_read, self._read = self._read, {}
        self._trust = trust
        self._ordinals.clear()

    def load(self, mesh: Any, hidden_slots: frozenset | None, read: Callable[[], ReadMesh]) -> ReadMesh:
        """What is read of a bpy mesh: trusted arrays, or what `read` returns, with old arrays where they are equal."""
        key = (mesh.as_pointer(), len(mesh.vertices), len(mesh.polygons), hidden_slots)
        found = self._last_read[key] if self._trust and key in self._last_read else read()
        if found.data is not None:
            found = replace(found, data=self._keep(found.data, hidden_slots))
        self._read[key] = found
        return found

    def _keep(self, mesh: MeshData, hidden_slots: frozenset) -> MeshData:
        ordinal = self._ordinals[mesh.name, hidden_slots]
        self._ordinals[mesh.name, hidden_slots] += 1
        key = (mesh.name, hidden_slots, ordinal)
        old = self._last.get(key)
        if old is not None and old is not mesh:
            positions = old.positions if _same(old.positions, mesh.positions) else mesh.positions
            triangles = old.triangles if _same(old.triangles, mesh.triangles) else mesh.triangles
            mesh = MeshData(mesh.name, positions, triangles)
        self._current[key] = mesh
        return mesh


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    # As bytes: a NaN equals itself here.
    return a.shape == b.shape and np.array_equal(a.view(np.uint32), b.view(np.uint32))


def read_counted(mesh: Any, name: str, hidden_slots: frozenset | None) -> ReadMesh:
    """As read_mesh, with the counts; `mesh` None: nothing, `hidden_slots` None: all faces are fully transparent."""
    triangles = 0 if mesh is None else count_triangles(mesh)
    if not triangles or hidden_slots is None:
        return ReadMesh(None, triangles, triangles)
    clear = _count_hidden_triangles(mesh, hidden_slots) if hidden_slots else 0
    return ReadMesh(read_mesh(mesh, name, hidden_slots), triangles, clear)


def count_triangles(mesh: Any) -> int:
    """Of a bpy mesh: a face of n corners has n - 2."""
    return len(mesh.loops) - 2 * len(mesh.polygons)


def read_mesh(mesh: Any, name: str, hidden_slots: frozenset = frozenset()) -> MeshData | None:
    """Positions and triangles of a bpy mesh; faces whose material index is in `hidden_slots` are left out. None if no
    triangle is left."""
    if len(mesh.polygons) == 0:
        return None
    mesh.calc_loop_triangles()
    triangles = _read_triangles(mesh)
    if hidden_slots:
        index = np.empty(len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("material_index", index)
        triangles = np.ascontiguousarray(triangles[~np.isin(index, list(hidden_slots))])
    if len(triangles) == 0:
        return None
    return MeshData(name, _read_positions(mesh), triangles)


def _read_positions(mesh: Any) -> np.ndarray:
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    attribute = mesh.attributes.get("position")
    if attribute is not None and len(attribute.data) == len(positions):  # 3.5+: a plain array, copied at once
        attribute.data.foreach_get("vector", positions.ravel())
    else:
        mesh.vertices.foreach_get("co", positions.ravel())
    return positions


def _read_triangles(mesh: Any) -> np.ndarray:
    triangles = np.empty((len(mesh.loop_triangles), 3), np.int32)
    corners = mesh.attributes.get(".corner_vert")  # 3.6+
    if corners is not None and len(mesh.loops) == triangles.size == 3 * len(mesh.polygons):
        # Every face is a triangle, so the corners are the triangles: a plain array, copied at once.
        corners.data.foreach_get("value", triangles.ravel())
    else:
        mesh.loop_triangles.foreach_get("vertices", triangles.ravel())
    return triangles.view(np.uint32)


def is_edited(mesh: Any) -> bool:
    """Whether an evaluated mesh is that of an edited object: it may then seem empty until `to_mesh` is asked for."""
    return bool(mesh.is_editmode)


@contextlib.contextmanager
def drawn_mesh(item: Any) -> Iterator[Any]:
    """What is drawn of an evaluated object, whatever its mode, as a mesh that lives for the `with` block; or None."""
    try:
        yield item.to_mesh()
    finally:
        item.to_mesh_clear()


def find_highest_material_index(item: Any) -> int:
    """The highest material index of an evaluated object's faces."""
    if not is_edited(item.data):
        return _find_highest_index(item.data)
    with drawn_mesh(item) as mesh:
        return 0 if mesh is None else _find_highest_index(mesh)


def _count_hidden_triangles(mesh: Any, hidden_slots: frozenset) -> int:
    """Triangles of the faces whose material index is in `hidden_slots`, counted by corners."""
    index = np.empty(len(mesh.polygons), np.int32)
    corners = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", index)
    mesh.polygons.foreach_get("loop_total", corners)
    return int((corners - 2)[np.isin(index, list(hidden_slots))].sum())


def _find_highest_index(mesh: Any) -> int:
    index = np.zeros(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", index)
    return int(index.max(initial=0))
