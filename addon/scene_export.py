# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated depsgraph -> SceneSnapshot: plain NumPy, no Blender object inside. Visibility as Cycles has it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from . import mesh_export
from .camera_export import export_camera
from .jobs import SceneLight, jobs_for
from .light_export import LightNamer, is_portal, light_template, object_name, placed
from .light_linking import LinkSets
from .materials import OPAQUE_FACTS, MaterialFacts, Opacity, examine, world_lights
from .picture import border_region, render_settings, render_size
from .scene_notes import find_light_notes, find_object_notes
from .scene_tally import Entry, Fate, SceneTally, is_shapeless
from .snapshot import (
    INSTANCE_CAMERA,
    INSTANCE_HOLDOUT,
    INSTANCE_SHADOW,
    CameraData,
    LightData,
    RenderSettings,
    SceneSnapshot,
)

_SKIPPED_KINDS = {
    "CURVES": "hair curves",
    "POINTCLOUD": "point clouds",
    "VOLUME": "volumes",
    "GPENCIL": "grease pencil",
    "GREASEPENCIL": "grease pencil",
}
_CURVE_KINDS = {"CURVE", "FONT", "META", "SURFACE"}
_NAMES_IN_A_WARNING = 5
_SHAPELESS = {"LIGHT", "CAMERA"}
_SHAPELESS_DATA = (
    bpy.types.Object,
    bpy.types.Light,
    bpy.types.Camera,
    bpy.types.Material,
    bpy.types.World,
    bpy.types.ShaderNodeTree,
)


@dataclass
class _Kind:
    """What all instances of one (object, data, instancer) have in common. Exactly one of mesh and light is set."""

    name: str
    mesh: int = -1
    flags: int = 0
    receiver_group: int = 0
    blocker_group: int = 0
    light: LightData | None = None
    light_data: Any = None
    instancer: str | None = None


class SceneExporter:
    """Exports one scene; kept over frames, it reuses the arrays of meshes that didn't change."""

    def __init__(self) -> None:
        self._store = mesh_export.MeshStore()

    def export(
        self,
        depsgraph: Any,
        camera: CameraData,
        render: RenderSettings,
        *,
        space: Any = None,
        same_meshes: bool = False,
    ) -> SceneSnapshot:
        """The scene of a depsgraph, with the jobs that its settings ask for. Call it where Blender allows to read the
        depsgraph (engine `update`, `view_update`). `space` is the 3D view, whose local view and filters count;
        `same_meshes` promises that no mesh changed since the last export of this depsgraph (see `only_moves`)."""
        self._store.begin(same_meshes)
        walk = _Walk(depsgraph, self._store, space)
        snapshot = SceneSnapshot(camera=camera, render=render)
        walk.fill(snapshot)
        scene, view_layer = depsgraph.scene_eval, depsgraph.view_layer_eval
        snapshot.jobs = jobs_for(scene, view_layer, walk.lights, walk.warnings)
        walk.note(find_light_notes(walk.lights, snapshot.jobs))
        walk.end_warnings()
        snapshot.warnings, snapshot.contents = walk.warnings, walk.tally.describe()
        snapshot.source = {
            "blender": bpy.app.version_string,
            "file": bpy.path.basename(bpy.data.filepath),
            "scene": scene.name,
            "view_layer": view_layer.name,
            "frame": scene.frame_current,
        }
        return snapshot


class _Walk:
    """One pass over the depsgraph's instances."""

    def __init__(self, depsgraph: Any, store: mesh_export.MeshStore, space: Any) -> None:
        self.depsgraph = depsgraph
        self.view_layer = depsgraph.view_layer_eval
        self.in_viewport = depsgraph.mode == "VIEWPORT"
        self._space = space
        self.lights: list[SceneLight] = []
        self.warnings: list[str] = []
        self._store = store
        self._kinds: list[_Kind] = []
        self._kind_of_entry: list[int] = []
        self._meshes: list[mesh_export.MeshData] = []
        self._mesh_index: dict[tuple[int, frozenset | None], tuple[int, mesh_export.ReadMesh]] = {}
        self._materials: dict[int, MaterialFacts] = {}
        self._named: dict[str, list[str]] = {}
        self.tally = SceneTally()
        light_objects = [item for item in bpy.data.objects if item.type == "LIGHT"]
        self._receivers = LinkSets("receiver", light_objects)
        self._blockers = LinkSets("blocker", light_objects)

    def fill(self, snapshot: SceneSnapshot) -> None:
        """Meshes, instances and lights into the snapshot."""
        kind_of = self._collect()
        count = len(kind_of)
        matrices = np.empty((count, 16), np.float32)
        self.depsgraph.object_instances.foreach_get("matrix_world", matrices.ravel())
        # Blender's matrices are column-major in memory.
        matrices = matrices.reshape(count, 4, 4).transpose(0, 2, 1)
        mesh_of_kind = np.array([kind.mesh for kind in self._kinds] + [-1], np.int64)
        is_mesh = mesh_of_kind[kind_of] >= 0
        kinds = kind_of[is_mesh]
        snapshot.meshes = self._meshes
        snapshot.instance_mesh = mesh_of_kind[kinds].astype(np.uint32)
        snapshot.instance_matrix = np.ascontiguousarray(matrices[is_mesh], np.float64)
        snapshot.instance_flags = self._per_instance("flags", kinds, np.uint32)
        snapshot.instance_receiver_group = self._per_instance("receiver_group", kinds, np.uint8)
        snapshot.instance_blocker_group = self._per_instance("blocker_group", kinds, np.uint8)
        names = [kind.name for kind in self._kinds]
        snapshot.instance_names = [names[k] for k in kinds.tolist()]
        self._place_lights(snapshot, kind_of, matrices)

    def _per_instance(self, name: str, kinds: np.ndarray, dtype: type) -> np.ndarray:
        return np.array([getattr(kind, name) for kind in self._kinds] + [0], dtype)[kinds]

    def _collect(self) -> np.ndarray:
        """The kind of each instance (-1: nothing to draw), in the depsgraph's order. The loop runs once per instance,
        so it does no more than tell kinds apart; no reference to an instance outlives its turn."""
        entries: dict[tuple[int, int, int], int] = {}
        found = []
        for instance in self.depsgraph.object_instances:
            item = instance.object
            data = item.data
            if data is None:
                found.append(-1)
                continue
            if instance.is_instance:
                key = (instance.instance_object.as_pointer(), data.as_pointer(), instance.parent.as_pointer())
            else:
                key = (item.as_pointer(), 0, 0)
            entry = entries.get(key)
            if entry is None:
                entry = entries[key] = self._new_entry(instance, item)
            found.append(entry if instance.show_self else -1)
        entry_of = np.array(found, np.int64)
        self.tally.end(entry_of)
        self._check_replaced()
        return np.array([*self._kind_of_entry, -1], np.int64)[entry_of]

    def _new_entry(self, instance: Any, item: Any) -> int:
        parent = instance.parent if instance.is_instance else None
        real = (instance.instance_object if parent is not None else item).original
        entry = Entry(item.name, item.type, Fate.HIDDEN, owner=object_name(real))
        seen = self._space is None or item.visible_in_viewport_get(self._space)
        kind = self._examine(instance, item, real, entry) if seen else None
        self._kind_of_entry.append(len(self._kinds) if kind is not None else -1)
        if kind is not None:
            self._kinds.append(kind)
        return self.tally.add(entry)

    def _examine(self, instance: Any, item: Any, real: Any, entry: Entry) -> _Kind | None:
        """What there is to draw, and in `entry` what becomes of it."""
        parent = instance.parent if instance.is_instance else None
        if item.type == "LIGHT":
            entry.fate = Fate.SHAPELESS if is_portal(item.data) else Fate.LIGHT
            return self._examine_light(item, real, parent)
        if instance.show_particles:
            self._warn_of_hair(item)
        if not isinstance(item.data, bpy.types.Mesh):
            self._sort_out(item, parent, entry)
            return None
        return self._examine_mesh(item, real, parent, entry)

    @staticmethod
    def _sort_out(item: Any, parent: Any, entry: Entry) -> None:
        """What has no mesh: nothing to see, something that comes again with a mesh, or a loss."""
        if item.type in _SKIPPED_KINDS:
            entry.fate, entry.reason = Fate.LEFT_OUT, f"{_SKIPPED_KINDS[item.type]} are not supported and left out"
        elif item.type in _CURVE_KINDS:
            # Geometry nodes also make curves as instances, which no renderer draws.
            entry.fate = Fate.REPLACED if parent is None or parent.type == "EMPTY" else Fate.EMPTY
            if item.type == "META":  # the first of a family (A, A.001, A.002) has the mesh of all
                entry.owner = re.sub(r"\.\d+$", "", entry.owner)
        elif is_shapeless(item.type):
            entry.fate = Fate.SHAPELESS
        else:
            entry.fate, entry.reason = Fate.LOST, f"objects of the type {item.type} are unknown and left out"

    def _examine_mesh(self, item: Any, real: Any, parent: Any, entry: Entry) -> _Kind | None:
        flags = self._flags(item, parent)
        if not flags:
            return None
        index, found = self._mesh(item, parent)
        entry.triangles, entry.clear = found.triangles, found.clear
        if real.type == "META":
            entry.owner = re.sub(r"\.\d+$", "", entry.owner)
        if found.data is None:
            entry.fate = Fate.TRANSPARENT if found.triangles else Fate.EMPTY
            if not found.triangles and _should_have_faces(item, real):
                entry.fate, entry.reason = Fate.LOST, "meshes that came out empty from Blender are lost"
            return None
        self.note(find_object_notes(self.depsgraph.scene_eval, item))
        entry.fate, entry.delivered = Fate.DELIVERED, found.data.triangle_count
        original_parent = parent.original if parent is not None else None
        return _Kind(
            item.name,
            mesh=index,
            flags=flags,
            receiver_group=self._receivers.group(original_parent, real),
            blocker_group=self._blockers.group(original_parent, real),
        )

    def _check_replaced(self) -> None:
        """Curves and the like whose mesh never came are lost, unless they have no faces."""
        for entry in self.tally.find_unreplaced():
            real = next((item for item in bpy.data.objects if object_name(item) == entry.owner), None)
            if real is None:
                continue
            with mesh_export.drawn_mesh(real.evaluated_get(self.depsgraph)) as mesh:
                entry.triangles = 0 if mesh is None else mesh_export.count_triangles(mesh)
            if entry.triangles:
                entry.fate, entry.reason = Fate.LOST, "curves whose mesh did not come from Blender are lost"
            else:
                entry.fate = Fate.EMPTY

    def _examine_light(self, item: Any, real: Any, parent: Any) -> _Kind | None:
        if is_portal(item.data):
            return None
        name = object_name(real)
        template = light_template(item.data, name)
        template.receiver_set = self._receivers.mask_of(real)
        template.blocker_set = self._blockers.mask_of(real)
        instancer = object_name(parent) if parent is not None else None
        return _Kind(name, light=template, light_data=item.data, instancer=instancer)

    def _place_lights(self, snapshot: SceneSnapshot, kind_of: np.ndarray, matrices: np.ndarray) -> None:
        namer = LightNamer()
        light_kinds = [number for number, kind in enumerate(self._kinds) if kind.light is not None]
        for index in np.flatnonzero(np.isin(kind_of, light_kinds)):
            kind = self._kinds[kind_of[index]]
            name = namer.name(kind.name, kind.instancer)
            snapshot.lights.append(placed(kind.light, name, matrices[index].astype(np.float64)))
            self.lights.append(SceneLight(name, kind.light_data))

    def _flags(self, item: Any, parent: Any) -> int:
        """Visibility as Cycles combines it: the object's and its instancer's; holdout and indirect-only of the
        instancer."""
        head = parent if parent is not None else item
        camera = item.visible_camera and (parent is None or parent.visible_camera)
        shadow = item.visible_shadow and (parent is None or parent.visible_shadow)
        holdout = head.holdout_get(view_layer=self.view_layer)
        if not holdout and head.indirect_only_get(view_layer=self.view_layer):
            camera = False
        flags = INSTANCE_CAMERA if camera else 0
        flags |= INSTANCE_HOLDOUT if camera and holdout else 0
        return flags | (INSTANCE_SHADOW if shadow else 0)

    def _mesh(self, item: Any, parent: Any) -> tuple[int, mesh_export.ReadMesh]:
        """The object's mesh without its fully transparent faces, and its index (-1: nothing is left)."""
        hidden = self._hidden_slots(item)
        mesh = item.data
        key = (mesh.as_pointer(), hidden)
        if key not in self._mesh_index:
            unfinished = self.in_viewport and parent is None and _data_is_not_final(item)
            # An edited mesh, and maybe others, seem empty until they are asked for.
            unfinished = unfinished or mesh_export.is_edited(mesh) or not len(mesh.polygons)

            def read() -> mesh_export.ReadMesh:
                if not unfinished:
                    return mesh_export.read_counted(mesh, mesh.name_full, hidden)
                with mesh_export.drawn_mesh(item) as drawn:
                    return mesh_export.read_counted(drawn, mesh.name_full, hidden)

            found = self._store.load(mesh, hidden, read)
            self._mesh_index[key] = (-1 if found.data is None else len(self._meshes)), found
            if found.data is not None:
                self._meshes.append(found.data)
        return self._mesh_index[key]

    def _hidden_slots(self, item: Any) -> frozenset | None:
        """Indices of the slots with fully transparent materials; None if that is the whole object."""
        override = self.view_layer.material_override
        if override is not None:
            return None if self._facts(override, item).opacity is Opacity.TRANSPARENT else frozenset()
        slots = [slot.material for slot in item.material_slots]
        if not slots:
            slots = list(item.data.materials) or [None]
        hidden = [i for i, m in enumerate(slots) if self._facts(m, item).opacity is Opacity.TRANSPARENT]
        if len(hidden) == len(slots):
            return None
        # Material indices beyond the last slot take the last slot.
        if hidden and hidden[-1] == len(slots) - 1:
            hidden += range(len(slots), mesh_export.find_highest_material_index(item) + 1)
        return frozenset(hidden)

    def _facts(self, material: Any, item: Any) -> MaterialFacts:
        if material is None:
            return OPAQUE_FACTS
        pointer = material.as_pointer()
        if pointer not in self._materials:
            facts = self._materials[pointer] = examine(material)
            if facts.opacity is Opacity.PARTIAL:
                self._name("materials with partial or textured transparency are taken as opaque", material.name)
        facts = self._materials[pointer]
        if facts.displaces:
            self._name("true displacement of materials is not followed: the surface is taken flat", material.name)
        if facts.emits:
            self._name("light of emissive meshes has no layer", item.name)
        return facts

    def _warn_of_hair(self, item: Any) -> None:
        for system in item.particle_systems:
            settings = system.settings
            if settings.type == "HAIR" and settings.render_type == "PATH":
                name = f"{item.name}: {system.name}"
                self.tally.add_left_out("particle hair is not supported and left out", name)

    def note(self, notes: Iterable[tuple[str, str]]) -> None:
        """Pairs of a warning and the name of what it is about."""
        for warning, name in notes:
            self._name(warning, name)

    def _name(self, warning: str, name: str) -> None:
        names = self._named.setdefault(warning, [])
        if name not in names:
            names.append(name)

    def end_warnings(self) -> None:
        """Ends the list of warnings: what was skipped or approximated, each named once."""
        for warning, names in self.tally.warn().items():
            for name in names:
                self._name(warning, name)
        for warning, names in self._named.items():
            listed = ", ".join(f'"{name}"' for name in names[:_NAMES_IN_A_WARNING])
            more = len(names) - _NAMES_IN_A_WARNING
            self.warnings.append(f"{warning}: {listed}" + (f" and {more} more" if more > 0 else ""))
        scene = self.depsgraph.scene_eval
        if world_lights(scene.world):
            self.warnings.append(f'light of the world "{scene.world.name}" has no layer')
        if self._receivers.overflow or self._blockers.overflow:
            self.warnings.append("light linking makes more than 63 groups; objects beyond them count as not linked")
        camera_data = getattr(scene.camera, "data", None)
        if getattr(getattr(camera_data, "dof", None), "use_dof", False) and not self.in_viewport:
            self.warnings.append(f'depth of field of camera "{scene.camera.name}" is not represented')
        if scene.render.use_motion_blur and not self.in_viewport:
            self.warnings.append("motion blur is not represented")


def only_moves(depsgraph: Any) -> bool:
    """Whether all that happened to a viewport's depsgraph since the last `view_update` leaves every mesh as it was.
    False if in doubt: a change of frame, for one, comes without any update."""
    updates = list(depsgraph.updates)
    return bool(updates) and all(isinstance(u.id, _SHAPELESS_DATA) and not _is_reshaped(u) for u in updates)


def _is_reshaped(update: Any) -> bool:
    is_object = isinstance(update.id, bpy.types.Object)
    return is_object and update.is_updated_geometry and update.id.type not in _SHAPELESS


def _should_have_faces(item: Any, real: Any) -> bool:
    """Whether nothing stands between an object's own faces and what is drawn: no modifier, no nodes, no edit."""
    data = real.data
    plain = real.type == "MESH" and real.mode != "EDIT" and not real.modifiers
    return plain and item.data.name == data.name and len(data.polygons) > 0


def _data_is_not_final(item: Any) -> bool:
    return item.mode != "OBJECT" or any(modifier.type == "SUBSURF" for modifier in item.modifiers)


def export_for_render(exporter: SceneExporter, depsgraph: Any, camera: Any) -> SceneSnapshot:
    """The snapshot of a render (F12): the scene's size, border, samples and the given camera object."""
    scene = depsgraph.scene_eval
    width, height = render_size(scene.render)
    region = border_region(scene.render, width, height)
    aspect = (scene.render.pixel_aspect_x, scene.render.pixel_aspect_y)
    camera_data = export_camera(camera, depsgraph, width, height, aspect)
    return exporter.export(depsgraph, camera_data, render_settings(scene, width, height, region))
