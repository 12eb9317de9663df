# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an OpenEXR file is whole. On a full disk Blender reports success and leaves half a file, and Python in it
can't read multilayer files; so the file's own table of contents is checked. Layout: OpenEXR, "OpenEXR File Layout".
No bpy, no pixels.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

MAGIC = 20000630
MULTIPART_BIT, TILED_BIT, DEEP_BIT = 0x1000, 0x200, 0x800
# Picture lines in a chunk, by compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
LINES_PER_CHUNK = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)


class ExrError(ValueError):
    """The file is no whole EXR; the text says in what way."""


@dataclass(frozen=True)
class ExrHeader:
    """`channels` by their full names, `size` width and height of the data."""

    channels: tuple[str, ...]
    size: tuple[int, int]


def read_attributes(data: bytes, position: int) -> tuple[dict[str, bytes], int]:
    """The header's attributes as raw bytes, and where it ends."""
    attributes = {}
    while data[position] != 0:
        name_end = data.index(b"\0", position)
        type_end = data.index(b"\0", name_end + 1)
        (length,) = struct.unpack_from("<i", data, type_end + 1)
        start = type_end + 5
        attributes[data[position:name_end].decode("utf-8", "replace")] = data[start : start + length]
        position = start + length
    return attributes, position + 1


def read_channel_names(chlist: bytes) -> tuple[str, ...]:
    names, position = [], 0
    while position < len(chlist) and chlist[position] != 0:
        end = chlist.index(b"\0", position)
        names.append(chlist[position:end].decode("utf-8", "replace"))
        position = end + 1 + 16  # pixel type, linearity, sampling
    return tuple(names)


def check_exr(path: Path) -> ExrHeader:
    """The header of a whole file of scan lines in one part. Raises ExrError; OSError if it can't be read."""
    data = path.read_bytes()
    try:
        magic, version = struct.unpack_from("<ii", data, 0)
        if magic != MAGIC or version & (MULTIPART_BIT | TILED_BIT | DEEP_BIT):
            raise ExrError("it is no EXR file of scan lines in one part")
        attributes, position = read_attributes(data, 8)
        left, bottom, right, top = struct.unpack("<iiii", attributes["dataWindow"])
        lines = LINES_PER_CHUNK[attributes["compression"][0]]
        count = -(-(top - bottom + 1) // lines)
        offsets = np.frombuffer(data, "<u8", count, position).astype(np.int64)
        if (offsets <= 0).any() or (offsets + 8 > len(data)).any():
            raise ExrError("its end is missing")
        for offset in offsets.tolist():
            (length,) = struct.unpack_from("<i", data, offset + 4)
            if length < 0 or offset + 8 + length > len(data):
                raise ExrError("its end is missing")
    except (struct.error, KeyError, IndexError) as error:
        raise ExrError("it is cut off or damaged") from error
    except ValueError as error:
        raise error if isinstance(error, ExrError) else ExrError("it is cut off or damaged") from error
    return ExrHeader(read_channel_names(attributes["channels"]), (right - left + 1, top - bottom + 1))
