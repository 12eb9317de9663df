# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG files from arrays: the one place. Blender has no Pillow, and its own writer applies colour management."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

SIGNATURE = b"\x89PNG\r\n\x1a\n"
COLOR_TYPES = {1: 0, 3: 2, 4: 6}  # channels: grey, RGB, RGBA
PALETTE_TYPE = 3
NO_FILTER, UP_FILTER = 0, 2


def make_chunk(kind: bytes, payload: bytes) -> bytes:
    return struct.pack(">I", len(payload)) + kind + payload + struct.pack(">I", zlib.crc32(kind + payload))


def encode_png(
    pixels: NDArray[np.uint8] | NDArray[np.uint16],
    *,
    palette: Sequence[tuple[int, int, int]] | None = None,
    text: dict[str, str] | None = None,
) -> bytes:
    """A PNG file's bytes. `pixels` uint8 or uint16, (h, w) or (h, w, 3 or 4), row 0 at the bottom as everywhere here
    (the file starts at the top). With `palette` (up to 256 RGB triples) `pixels` are uint8 indices (h, w). `text`:
    notes in the file, Latin-1 keys and UTF-8 values."""
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    if pixels.dtype not in (np.uint8, np.uint16) or channels not in COLOR_TYPES or pixels.size == 0:
        raise ValueError(
            f"PNG needs uint8 or uint16 of shape (h, w), (h, w, 3) or (h, w, 4), not {pixels.dtype} {pixels.shape}"
        )
    height, width = pixels.shape[:2]
    depth = 8 * pixels.dtype.itemsize
    color_type = COLOR_TYPES[channels] if palette is None else PALETTE_TYPE
    rows = np.ascontiguousarray(pixels[::-1].astype(pixels.dtype.newbyteorder(">"))).view(np.uint8).reshape(height, -1)
    lines = np.empty((height, rows.shape[1] + 1), dtype=np.uint8)
    if palette is None and depth == 8:  # differences to the row above: large even areas become zeros
        lines[:, 0] = UP_FILTER
        lines[0, 1:] = rows[0]
        np.subtract(rows[1:], rows[:-1], out=lines[1:, 1:])
    else:
        lines[:, 0] = NO_FILTER
        lines[:, 1:] = rows
    parts = [SIGNATURE, make_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, color_type, 0, 0, 0))]
    if palette is not None:
        parts.append(make_chunk(b"PLTE", bytes(value for color in palette for value in color)))
    for key, value in (text or {}).items():
        body = key.encode("latin-1", "replace")[:79] + b"\0\0\0\0\0" + value.encode("utf-8")
        parts.append(make_chunk(b"iTXt", body))
    parts.append(make_chunk(b"IDAT", zlib.compress(lines.tobytes(), 6)))
    parts.append(make_chunk(b"IEND", b""))
    return b"".join(parts)
