# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pass names. No bpy, no native module.

Blender cuts the whole EXR channel name `layer.pass.X` to 63 bytes (3.4), joins passes whose cut names are equal, and
takes a dot in a pass name for the end of the layer name when the file is read again. So a pass name has no dots and at
most PASS_NAME_BYTES bytes of UTF-8; the light's full name is kept in the picture's metadata.
"""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

PASS_NAME_BYTES = 32
EXR_NAME_BYTES = 63  # of the whole `layer.pass.X`, before Blender 5.0
COVERAGE_PASS = "Coverage"
RESERVED_PASSES = frozenset({"Combined", COVERAGE_PASS})
_DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"


@dataclass(frozen=True)
class PassKey:
    """What a pass holds: an output of a technique for a light. `output` is empty for the visibility."""

    light: str
    technique: str
    output: str = ""


def pass_names(keys: Sequence[PassKey]) -> list[str]:
    """A unique name for each key, in order. A name depends on its own key alone unless two would be equal; then those
    that had to be changed (dots, length) get a hash of their full key, so that the lights' order doesn't matter."""
    drafts = [_draft(key) for key in keys]
    count = Counter(name for name, _changed in drafts)
    count.update(RESERVED_PASSES)
    names = [
        _with_hash(key) if changed and count[name] > 1 else name
        for key, (name, changed) in zip(keys, drafts, strict=True)
    ]
    taken: set[str] = set(RESERVED_PASSES)
    for index, name in enumerate(names):
        unique, salt = name, 0
        while unique in taken:
            salt += 1
            unique = _with_hash(keys[index], salt)
        taken.add(unique)
        names[index] = unique
    return names


def is_cut_in_exr(view_layer: str, pass_name: str) -> bool:
    """True if the pass's channels don't fit into EXR_NAME_BYTES, whatever their one-letter ids."""
    return len(f"{view_layer}.{pass_name}.X".encode()) > EXR_NAME_BYTES


def short_hash(text: str, length: int = 4) -> str:
    """Base-36 digits of a CRC of the text: stable over runs and machines."""
    value, digits = zlib.crc32(text.encode("utf-8", "surrogatepass")), ""
    for _ in range(length):
        value, digit = divmod(value, 36)
        digits += _DIGITS[digit]
    return digits


def clean(text: str) -> str:
    """Without dots and control characters, which EXR channel names and Blender's reader don't survive."""
    return "".join("_" if c == "." or not c.isprintable() else c for c in text)


def _cut(text: str, bytes_left: int) -> str:
    return text.encode("utf-8", "replace")[: max(bytes_left, 0)].decode("utf-8", "ignore").rstrip()


def _tail(key: PassKey) -> str:
    return f" {clean(key.technique)}" + (f" {clean(key.output)}" if key.output else "")


def _draft(key: PassKey) -> tuple[str, bool]:
    """The wished name, and whether it differs from the plain `Shadow LIGHT technique`."""
    light, tail = clean(key.light), _tail(key)
    name = f"Shadow {light}{tail}"
    if len(name.encode("utf-8", "replace")) <= PASS_NAME_BYTES:
        return name, light != key.light
    return _with_hash(key), True


def _with_hash(key: PassKey, salt: int = 0) -> str:
    digest = short_hash(f"{key.light}\n{key.technique}\n{key.output}" + (f"\n{salt}" if salt else ""))
    tail = _cut(_tail(key), PASS_NAME_BYTES - len("Shadow ") - len(digest) - 2)
    room = PASS_NAME_BYTES - len(f"Shadow ~{digest}") - len(tail.encode("utf-8"))
    return f"Shadow {_cut(clean(key.light), room)}~{digest}{tail}"
