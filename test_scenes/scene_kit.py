# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the generators of the test scenes share: an empty file, meshes from NumPy arrays, lights, camera, saving.

A generator defines `build(options)` and ends with `main(build, __doc__)`. It runs in every supported Blender both ways:

    blender -b -P test_scenes/box.py -- OUT.blend [options]
    python test_scenes/box.py OUT.blend [options]              (an environment with the bpy wheel)

Everything is in metres, Z up. Same arguments, same scene: all randomness comes from a seeded generator.
"""

import argparse
import math
import os
import sys
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

Point = Sequence[float]


# --- running a generator ---------------------------------------------------------------------------------------------
def main(
    build: Callable[[argparse.Namespace], None],
    description: str,
    add_options: Callable[[argparse.ArgumentParser], None] | None = None,
) -> None:
    """Parses the command line, builds into an empty file, saves it, prints one line and ends the process."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(prog=Path(sys.argv[0]).name, description=description.splitlines()[0])
    parser.add_argument("out", metavar="OUT.blend", help="file to write")
    if add_options:
        add_options(parser)
    code = 1
    try:
        options = parser.parse_args(arguments)
        start_file()
        build(options)
        path = Path(options.out).resolve()
        path.parent.mkdir(parents=True, exist_ok=True)
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
        print(f"{path.name}: {count_triangles():,} triangles, {count_lights()} lights", flush=True)
        code = 0
    except SystemExit as stop:  # argparse
        code = stop.code if isinstance(stop.code, int) else 1
    except Exception:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)  # Blender as a module can hang at interpreter exit


def start_file() -> None:
    """An empty factory file, 1280 x 720, Cycles with plain settings, standard view, no world light."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 32
    scene.cycles.use_denoising = False  # Debian's Blender is built without the denoiser
    scene.render.resolution_x, scene.render.resolution_y = 1280, 720
    scene.view_settings.view_transform = "Standard"
    world = bpy.data.worlds.new("World")
    world.color = (0.05, 0.055, 0.065)
    scene.world = world


def count_triangles() -> int:
    """Triangles of everything that renders, instances counted each, at render settings of the modifiers."""
    for thing in bpy.data.objects:  # the depsgraph at hand is the viewport's
        for modifier in thing.modifiers:
            if modifier.type == "SUBSURF":
                modifier.levels = modifier.render_levels
    graph = bpy.context.evaluated_depsgraph_get()
    graph.update()
    count = 0
    for instance in graph.object_instances:
        if instance.object.type == "MESH" and (instance.show_self or instance.is_instance):
            mesh = instance.object.data
            count += len(mesh.loops) - 2 * len(mesh.polygons)
    return count


def count_lights() -> int:
    return sum(thing.type == "LIGHT" for thing in bpy.context.scene.objects)


# --- meshes as arrays ------------------------------------------------------------------------------------------------
class Shape:
    """Positions (n, 3) float32 and faces (m, 3 or 4) int32; faces of one count a shape."""

    def __init__(self, positions: np.ndarray, faces: np.ndarray):
        self.positions = np.asarray(positions, dtype=np.float32).reshape(-1, 3)
        self.faces = np.asarray(faces, dtype=np.int32)

    def transformed(self, matrix: Matrix) -> "Shape":
        turn = np.array(matrix.to_3x3(), dtype=np.float64)
        moved = self.positions @ turn.T + np.array(matrix.translation)
        return Shape(moved, self.faces)

    def moved(self, offset: Point) -> "Shape":
        return Shape(self.positions + np.asarray(offset, dtype=np.float32), self.faces)


def joined(shapes: Sequence[Shape]) -> Shape:
    """One shape of several with the same face size; vertices are not merged."""
    starts = np.cumsum([0, *(len(shape.positions) for shape in shapes)])
    faces = np.concatenate([shape.faces + start for shape, start in zip(shapes, starts, strict=False)])
    return Shape(np.concatenate([shape.positions for shape in shapes]), faces)


def grid(columns: int, rows: int, *, close_columns: bool = False, close_rows: bool = False) -> np.ndarray:
    """Quads over a grid of (rows, columns) vertices stored row by row; closing joins last to first."""
    column = np.arange(columns if close_columns else columns - 1)
    row = np.arange(rows if close_rows else rows - 1)[:, None]
    right, up = (column + 1) % columns, (row + 1) % rows
    corners = (row * columns + column, row * columns + right, up * columns + right, up * columns + column)
    return np.stack(np.broadcast_arrays(*corners), axis=-1).reshape(-1, 4)


def box(size: Point, centre: Point = (0, 0, 0)) -> Shape:
    """An axis-aligned box of 6 quads."""
    corners = np.array([[x, y, z] for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return Shape(corners * np.asarray(size) + np.asarray(centre), np.array(faces))


def cube_grid(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """The surface of a cube of cells^3: integer places (n, 3) from 0 to cells, and welded outward quads (m, 4)."""
    steps = np.arange(cells + 1)
    v, u = np.meshgrid(steps, steps, indexing="ij")
    places, quads = [], []
    for axis in range(3):
        for high in (False, True):
            place = np.empty(((cells + 1) ** 2, 3), dtype=np.int64)
            place[:, axis] = cells if high else 0
            place[:, (axis + 1) % 3], place[:, (axis + 2) % 3] = u.ravel(), v.ravel()
            face = grid(cells + 1, cells + 1) + len(places) * (cells + 1) ** 2
            places.append(place)
            quads.append(face if high else face[:, ::-1])
    unique, index = np.unique(np.concatenate(places), axis=0, return_inverse=True)
    return unique, index.reshape(-1)[np.concatenate(quads)]


def rounded_box(size: Point, radius: float, steps: int = 2) -> Shape:
    """A box with its edges rounded by `steps` cells a side, closed and welded: 12 * (2 * steps + 1)^2 triangles."""
    cells = 2 * steps + 1
    places, quads = cube_grid(cells)
    # Slope of the normal at a grid line, -1..1: `steps` lines bend round each edge, one flat cell lies between.
    bent = np.tan(np.linspace(-math.pi / 4, 0, steps + 1))
    slopes = np.concatenate([bent, -bent[::-1]])[places]
    normals = slopes / np.linalg.norm(slopes, axis=1, keepdims=True)
    corner = np.asarray(size) / 2 - radius
    return Shape(np.where(places > steps, corner, -corner) + radius * normals, quads)


def ball(cells: int = 6) -> Shape:
    """A unit sphere of 6 * cells^2 quads, closed and welded, without poles."""
    places, quads = cube_grid(cells)
    slopes = np.tan((places / cells - 0.5) * (math.pi / 2))
    return Shape(slopes / np.linalg.norm(slopes, axis=1, keepdims=True), quads)


def tube(path: Sequence[Point], radius: float | Sequence[float], sides: int = 8, *, closed: bool = False) -> Shape:
    """A round tube along a path, open at its ends; `closed` joins the last ring to the first."""
    path = np.asarray(path, dtype=np.float64)
    count = len(path)
    tangent = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0) if closed else np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    # Carry one frame along the path, so that the tube does not twist where the direction turns.
    side = np.empty_like(path)
    first = np.cross(tangent[0], [0, 0, 1] if abs(tangent[0][2]) < 0.9 else [1, 0, 0])
    side[0] = first / np.linalg.norm(first)
    for k in range(1, count):
        carried = side[k - 1] - tangent[k] * np.dot(side[k - 1], tangent[k])
        side[k] = carried / np.linalg.norm(carried)
    other = np.cross(tangent, side)
    if closed:  # the frame comes back turned: every ring takes its part of that, so that last and first fit
        end = side[-1] - tangent[0] * np.dot(side[-1], tangent[0])
        twist = math.atan2(np.dot(end, other[0]), np.dot(end, side[0])) * np.arange(count) / count
        cosine, sine = np.cos(twist)[:, None], np.sin(twist)[:, None]
        side, other = cosine * side - sine * other, cosine * other + sine * side
    turn = np.arange(sides) * (2 * math.pi / sides)
    radii = np.broadcast_to(np.asarray(radius, dtype=np.float64), (count,))[:, None, None]
    rings = path[:, None] + radii * (
        np.cos(turn)[None, :, None] * side[:, None] + np.sin(turn)[None, :, None] * other[:, None]
    )
    return Shape(rings.reshape(-1, 3), grid(sides, count, close_columns=True, close_rows=closed))


def turned(profile: Sequence[Point], sides: int = 48) -> Shape:
    """A surface of revolution about Z. profile: (radius, height) pairs, bottom to top."""
    profile = np.asarray(profile, dtype=np.float64)
    turn = np.arange(sides) * (2 * math.pi / sides)
    rings = np.stack(
        [
            profile[:, :1] * np.cos(turn),
            profile[:, :1] * np.sin(turn),
            np.broadcast_to(profile[:, 1:], (len(profile), sides)),
        ],
        axis=-1,
    )
    return Shape(rings.reshape(-1, 3), grid(sides, len(profile), close_columns=True))


# --- into Blender ----------------------------------------------------------------------------------------------------
def new_mesh(name: str, shape: Shape, *, smooth: bool = False) -> bpy.types.Mesh:
    """A Blender mesh of the arrays, without a loop in Python."""
    mesh = bpy.data.meshes.new(name)
    corner_count = shape.faces.shape[1]
    face_count = len(shape.faces)
    mesh.vertices.add(len(shape.positions))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(shape.positions).ravel())
    mesh.loops.add(face_count * corner_count)
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(shape.faces).ravel())
    mesh.polygons.add(face_count)
    mesh.polygons.foreach_set("loop_start", np.arange(face_count, dtype=np.int32) * corner_count)
    if bpy.app.version < (3, 6, 0):  # derived from loop_start and read-only afterwards
        mesh.polygons.foreach_set("loop_total", np.full(face_count, corner_count, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.full(face_count, smooth))
    mesh.update(calc_edges=True)
    return mesh


def add_object(name: str, data, *, material=None, place: Matrix | Point | None = None, collection=None):
    """An object of `data` (a mesh, a light, a camera, a Shape, or None for an empty) in the scene or a collection."""
    if isinstance(data, Shape):
        data = new_mesh(name, data)
    thing = bpy.data.objects.new(name, data)
    if material and not data.materials:
        data.materials.append(material)
    if place is not None:
        thing.matrix_world = place if isinstance(place, Matrix) else Matrix.Translation(Vector(place))
    (collection or bpy.context.scene.collection).objects.link(thing)
    return thing


def new_material(name: str, color: Point, roughness: float = 0.7) -> bpy.types.Material:
    """A plain surface; color is linear RGB."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    material.diffuse_color = (*color, 1.0)
    return material


def looking(place: Point, target: Point) -> Matrix:
    """World matrix of a camera or light at `place` whose -Z points to `target`."""
    direction = Vector(target) - Vector(place)
    return Matrix.Translation(Vector(place)) @ direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()


def add_camera(place: Point, target: Point, *, lens_mm: float = 35.0, clip_end: float = 1000.0):
    data = bpy.data.cameras.new("Camera")
    data.lens, data.clip_end = lens_mm, clip_end
    camera = add_object("Camera", data, place=looking(place, target))
    bpy.context.scene.camera = camera
    return camera


def add_light(
    kind: str, name: str, place: Point, target: Point, energy: float, *, color: Point = (1, 1, 1), **settings
):
    """kind: SUN, SPOT, POINT or AREA; settings are attributes of the light data (spot_size, shadow_soft_size, ...)."""
    data = bpy.data.lights.new(name, kind)
    data.energy, data.color = energy, color
    for key, value in settings.items():
        setattr(data, key, value)
    return add_object(name, data, place=looking(place, target))
