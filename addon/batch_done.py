# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What an earlier run of the batch has left, for --skip-existing. No bpy."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

# What the whole list must have in common with the one that this run would write.
HEAD_FIELDS = (
    "schema",
    "schema_version",
    "file",
    "scene",
    "camera",
    "truths",
    "truth_samples",
    "border_samples",
    "causes",
    "temporal_move",
)
FILE_FIELDS = ("file", "picture", "layer_picture", "truth_picture", "difference_picture")


@dataclass(frozen=True)
class Wanted:
    """What is asked of a frame. `layers`: (view layer, light, technique, resolved settings)."""

    resolution: list[int]
    region: list[int]  # x, y, width, height
    samples: int
    layers: list[tuple[str, str, str, dict[str, Any]]]


def are_same_settings(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Equal but for the rounding of Blender's float32 properties."""
    if one.keys() != other.keys():
        return False
    for key, value in one.items():
        if isinstance(value, float) and isinstance(other[key], int | float):
            if not math.isclose(value, other[key], rel_tol=1e-6, abs_tol=1e-9):
                return False
        elif value != other[key]:
            return False
    return True


class DoneBefore:
    """The list that an earlier run wrote, whose files may still be there. `head`: the fields of this run's own list."""

    def __init__(self, json_path: Path, folder: Path, head: dict[str, Any]) -> None:
        self._folder = folder
        self._document: dict[str, Any] = {}
        try:
            document = json.loads(json_path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return
        if isinstance(document, dict) and all(document.get(name) == head.get(name) for name in HEAD_FIELDS):
            self._document = document

    def find(self, frame: int, wanted: Wanted, layer_list: str) -> tuple[list[Any], list[Any]] | None:
        """The frame's records in "frames" and in `layer_list`, if they are all that is wanted and their files exist."""
        frames = [record for record in self._document.get("frames", []) if record["frame"] == frame]
        layers = [record for record in self._document.get(layer_list, []) if record["frame"] == frame]
        picture = {"resolution": wanted.resolution, "region": wanted.region, "samples": wanted.samples}
        if not frames or any(record.get(name) != picture[name] for record in frames for name in picture):
            return None
        for view_layer, light, technique, settings in wanted.layers:
            if not any(
                (record["view_layer"], record["light"], record["technique"]) == (view_layer, light, technique)
                and are_same_settings(settings, record["settings"])
                for record in layers
            ):
                return None
        names = {record[field] for record in frames + layers for field in FILE_FIELDS if field in record}
        if not all((self._folder / name).is_file() for name in names):
            return None
        return frames, layers
