# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on's tests share: building small scenes, rendering them with a capture, reading EXR files."""

import struct
from pathlib import Path

import bpy
import numpy as np


def add_object(name: str, data, location=(0, 0, 0), collection=None) -> bpy.types.Object:
    """Links a new object to the scene (or a collection)."""
    made = bpy.data.objects.new(name, data)
    made.location = location
    (collection or bpy.context.scene.collection).objects.link(made)
    return made


def make_mesh(name: str, vertices, faces) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    return mesh


def plane_mesh(size: float = 2.0, name: str = "Plane") -> bpy.types.Mesh:
    h = size / 2
    return make_mesh(name, [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [(0, 1, 2, 3)])


def cube_mesh(size: float = 2.0, name: str = "Cube") -> bpy.types.Mesh:
    h = size / 2
    corners = [(x * h, y * h, z * h) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return make_mesh(name, corners, faces)


def add_light(kind: str, name: str | None = None, location=(0, 0, 5), **properties) -> bpy.types.Object:
    light = bpy.data.lights.new(name or kind.title(), kind)
    for key, value in properties.items():
        setattr(light, key, value)
    return add_object(name or kind.title(), light, location)


def add_camera(location=(0, 0, 10), name: str = "Camera", **properties) -> bpy.types.Object:
    """A camera that looks down; it becomes the scene's."""
    data = bpy.data.cameras.new(name)
    for key, value in properties.items():
        setattr(data, key, value)
    camera = add_object(name, data, location)
    bpy.context.scene.camera = camera
    return camera


def render(**operator_options):
    """Renders the current scene with a capture and returns what it collected."""
    from addon import engine

    with engine.capture() as captured:
        bpy.ops.render.render(**operator_options)
    return captured


def exported():
    """The snapshot of the current scene's active (only) view layer, as an F12 exports it."""
    captured = render()
    assert not captured.errors
    return captured.frames[0].snapshot


def failed_render() -> str:
    """Renders a scene that must be refused; returns the one error that was reported."""
    from addon import engine

    with engine.capture() as captured:
        try:
            bpy.ops.render.render()
        except RuntimeError as error:
            reported = str(error)
        else:
            raise AssertionError("the render was not refused")
    assert len(captured.errors) == 1, captured.errors
    assert captured.errors[0] in reported
    assert not captured.frames
    return captured.errors[0]


def world_triangles(snapshot) -> np.ndarray:
    """All triangles of a snapshot in world space, (n, 3, 3), in an order that doesn't depend on the export's."""
    parts = [np.zeros((0, 3, 3))]
    for mesh, matrix in zip(snapshot.instance_mesh, snapshot.instance_matrix, strict=True):
        data = snapshot.meshes[mesh]
        points = data.positions.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
        parts.append(points[data.triangles])
    return sort_triangles(np.concatenate(parts))


def sort_triangles(triangles: np.ndarray) -> np.ndarray:
    centres = np.round(triangles.mean(axis=1), 3)
    return triangles[np.lexsort(centres.T)]


def set_multilayer_output(path: Path, codec: str = "NONE", depth: str = "32") -> None:
    """Multilayer EXR in one part, at that path (with suffix)."""
    render_settings = bpy.context.scene.render
    settings = render_settings.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = depth
    settings.exr_codec = codec
    if hasattr(settings, "use_exr_interleave"):
        settings.use_exr_interleave = True
    render_settings.filepath = str(path)
    render_settings.use_file_extension = False


_PIXEL_TYPES = {0: np.uint32, 1: np.float16, 2: np.float32}


def read_exr(path: Path) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """(channels (h, w) with row 0 at the bottom, string attributes) of an uncompressed single-part scanline EXR."""
    data = Path(path).read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01", f"{path} is no EXR file"
    assert not data[5] & 0x12, "multi-part or deep: not read here"
    attributes, at = _read_header(data, 8)
    channels = _channel_list(attributes["channels"][1])
    assert len({name for name, _ in channels}) == len(channels), "a channel is there twice"
    assert attributes["compression"][1] == b"\0", "write with codec NONE"
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    pictures = {name: np.zeros((height, width), np.float32) for name, _ in channels}
    for offset in struct.unpack_from(f"<{height}Q", data, at):
        y, _size = struct.unpack_from("<ii", data, offset)
        place = offset + 8
        for name, dtype in channels:
            row = np.frombuffer(data, dtype, width, place)
            pictures[name][height - 1 - (y - y0)] = row
            place += row.nbytes
    strings = {k: v.decode("utf-8", "replace") for k, (kind, v) in attributes.items() if kind == "string"}
    return pictures, strings


def _read_header(data: bytes, at: int) -> tuple[dict[str, tuple[str, bytes]], int]:
    attributes = {}
    while data[at]:
        name, at = _c_string(data, at)
        kind, at = _c_string(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = (kind, data[at + 4 : at + 4 + size])
        at += 4 + size
    return attributes, at + 1


def _c_string(data: bytes, at: int) -> tuple[str, int]:
    end = data.index(b"\0", at)
    return data[at:end].decode("utf-8", "replace"), end + 1


def _channel_list(data: bytes) -> list[tuple[str, type]]:
    found, at = [], 0
    while data[at]:
        name, at = _c_string(data, at)
        (kind,) = struct.unpack_from("<i", data, at)
        found.append((name, _PIXEL_TYPES[kind]))
        at += 16
    return found
