# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the depsgraph holds against what the export delivered: each instance has one fate, and what is lost is named.

Triangles are counted here from faces and corners alone, not from the triangles that the export reads: two ways to the
same number, so that neither can lose any in silence.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

NAMES_IN_A_LOSS = 20
# Types of objects that have no surface in any render.
_SHAPELESS = {"ARMATURE", "CAMERA", "EMPTY", "LATTICE", "LIGHT_PROBE", "LIGHTPROBE", "SPEAKER"}


class Fate(Enum):
    """What became of an instance. Of these LEFT_OUT and LOST are in Cycles' picture and not in the layers."""

    DELIVERED = "delivered"
    LIGHT = "lights"
    HIDDEN = "hidden"  # not shown in this render, or by no ray
    TRANSPARENT = "transparent"  # all faces fully transparent
    REPLACED = "replaced"  # a curve or the like, which comes again with a mesh
    EMPTY = "empty"  # no faces
    SHAPELESS = "shapeless"  # empties, armatures, cameras, portals and so on
    LEFT_OUT = "left_out"  # not supported
    LOST = "lost"  # a defect: it should be here


_NO_SURFACE = {Fate.LIGHT, Fate.REPLACED, Fate.SHAPELESS}


@dataclass
class Entry:
    """What all instances of one (object, data, instancer) have in common. `kind` is Blender's type of the evaluated
    object, `triangles` what one instance holds, `delivered` what of it was exported, `clear` what of it belongs to
    fully transparent materials."""

    name: str
    kind: str
    fate: Fate
    reason: str = ""
    owner: str = ""  # the original object's name with its library: of a curve and of its mesh the same
    triangles: int = 0
    delivered: int = 0
    clear: int = 0

    @property
    def missing(self) -> int:
        """Triangles of one instance that should have been delivered."""
        return self.triangles - self.delivered - self.clear


def is_shapeless(kind: str) -> bool:
    """Whether objects of that type have no surface."""
    return kind in _SHAPELESS


@dataclass
class SceneTally:
    """Filled while the depsgraph is walked. `add` returns an entry's number, `end` takes that of each instance."""

    entries: list[Entry] = field(default_factory=list)
    hidden_count: int = 0
    _counts: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    _extra: dict[str, dict[str, None]] = field(default_factory=dict)

    def add(self, entry: Entry) -> int:
        self.entries.append(entry)
        return len(self.entries) - 1

    def end(self, entry_of_instance: np.ndarray) -> None:
        """The entry of each instance; -1: not shown."""
        shown = entry_of_instance[entry_of_instance >= 0]
        self.hidden_count = len(entry_of_instance) - len(shown)
        self._counts = np.bincount(shown, minlength=len(self.entries))
        self._find_lost()

    def add_left_out(self, reason: str, name: str) -> None:
        """Something that is no instance: a particle system's hair."""
        self._extra.setdefault(reason, {})[name] = None

    def _find_lost(self) -> None:
        for entry in self.entries:
            if entry.fate in {Fate.DELIVERED, Fate.TRANSPARENT} and entry.missing:
                entry.reason = "not all triangles were exported; please report it with the scene"
                entry.fate = Fate.LOST if entry.fate is Fate.TRANSPARENT else entry.fate

    def find_unreplaced(self) -> list[Entry]:
        """Curves and the like that were expected to come again with a mesh, and did not."""
        arrived = {entry.owner for entry in self.entries if entry.fate is not Fate.REPLACED}
        return [entry for entry in self.entries if entry.fate is Fate.REPLACED and entry.owner not in arrived]

    def _losses(self) -> dict[str, list[tuple[Entry, int]]]:
        found: dict[str, list[tuple[Entry, int]]] = {}
        for entry, count in zip(self.entries, self._counts.tolist(), strict=True):
            if count and entry.reason and entry.fate in {Fate.LEFT_OUT, Fate.LOST, Fate.DELIVERED}:
                found.setdefault(entry.reason, []).append((entry, count))
        return found

    def warn(self) -> dict[str, list[str]]:
        """Names by warning: what is in Cycles' picture and not in the layers."""
        named = {reason: [entry.name for entry, _ in pairs] for reason, pairs in self._losses().items()}
        for reason, names in self._extra.items():
            named.setdefault(reason, []).extend(names)
        return named

    def describe(self) -> dict[str, Any]:
        """For lists: what is held and delivered (objects, instances, triangles; by kind too), the rest by its fate,
        and each loss with its names."""
        surfaces: list[tuple[Entry, int]] = []
        others: dict[str, list[tuple[Entry, int]]] = {}
        for entry, count in zip(self.entries, self._counts.tolist(), strict=True):
            if count and entry.fate not in _NO_SURFACE:
                surfaces.append((entry, count))
            if count and entry.fate is not Fate.DELIVERED:
                others.setdefault(entry.fate.value, []).append((entry, count))
        kinds = dict.fromkeys(entry.kind for entry, _ in surfaces)
        by_kind = {name: [pair for pair in surfaces if pair[0].kind == name] for name in kinds}
        return {
            "held": _sum_held(surfaces),
            "delivered": _sum_delivered(surfaces),
            "by_kind": {
                name: {"held": _sum_held(pairs), "delivered": _sum_delivered(pairs)} for name, pairs in by_kind.items()
            },
            "others": {name: _sum_held(pairs) for name, pairs in others.items()},
            "not_shown": self.hidden_count,
            "losses": [*self._describe_losses(), *self._describe_extra()],
        }

    def _describe_losses(self) -> list[dict[str, Any]]:
        return [
            {
                "reason": reason,
                "expected": all(entry.fate is Fate.LEFT_OUT for entry, _ in pairs),
                **_sum_held(pairs),
                "triangles": sum(count * entry.missing for entry, count in pairs),
                "names": list(dict.fromkeys(entry.name for entry, _ in pairs))[:NAMES_IN_A_LOSS],
            }
            for reason, pairs in self._losses().items()
        ]

    def _describe_extra(self) -> list[dict[str, Any]]:
        return [
            {
                "reason": reason,
                "expected": True,
                "objects": len(names),
                "instances": len(names),
                "triangles": 0,
                "names": list(names)[:NAMES_IN_A_LOSS],
            }
            for reason, names in self._extra.items()
        ]


def _sum_held(pairs: list[tuple[Entry, int]]) -> dict[str, int]:
    return {
        "objects": len({entry.owner for entry, _ in pairs}),
        "instances": sum(count for _, count in pairs),
        "triangles": sum(count * entry.triangles for entry, count in pairs),
    }


def _sum_delivered(pairs: list[tuple[Entry, int]]) -> dict[str, int]:
    found = [pair for pair in pairs if pair[0].fate is Fate.DELIVERED]
    return {**_sum_held(found), "triangles": sum(count * entry.delivered for entry, count in found)}
