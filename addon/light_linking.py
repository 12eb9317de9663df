# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and shadow linking (Blender 4.0+) as group numbers of objects and bit sets of lights.

Blender keeps the resolved sets to itself, so they are resolved here from the lights' collections by the same rules:
objects that the same collections include or exclude share a group; a light with any inclusion reaches only the groups
that its collection includes; excluded groups are always left out; group 0 is every object that no collection names. An
object named both by a child collection and directly takes the direct state, for direct members come last.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from .snapshot import ALL_GROUPS

MAX_GROUPS = 64


class LinkSets:
    """One kind of linking ("receiver" or "blocker") resolved over a scene. Keys are original objects' pointers."""

    def __init__(self, kind: str, light_objects: Iterable[Any]) -> None:
        self.group_of: dict[int, int] = {}
        self.overflow = False
        self._kind = kind
        self._collection_of: dict[int, int] = {}  # light object -> collection number
        self._masks: list[int] = []  # collection number -> groups it reaches
        members: dict[int, dict[int, bool]] = {}  # object -> collection number -> included?
        numbers: dict[int, int] = {}
        for light in light_objects:
            collection = self._collection(light)
            if collection is None:
                continue
            pointer = collection.as_pointer()
            if pointer not in numbers:
                if len(numbers) >= MAX_GROUPS:
                    self.overflow = True
                    continue
                numbers[pointer] = len(numbers)
                for object_pointer, included in _members(collection):
                    members.setdefault(object_pointer, {})[numbers[pointer]] = included
            self._collection_of[light.as_pointer()] = numbers[pointer]
        self._assign_groups(members, len(numbers))

    def _collection(self, light: Any) -> Any:
        linking = getattr(light, "light_linking", None)
        return getattr(linking, f"{self._kind}_collection", None)

    def _assign_groups(self, members: dict[int, dict[int, bool]], collection_count: int) -> None:
        groups: dict[frozenset, int] = {}
        included, excluded = [0] * collection_count, [0] * collection_count
        for object_pointer, states in members.items():
            group = groups.setdefault(frozenset(states.items()), len(groups) + 1)
            if group >= MAX_GROUPS:
                self.overflow = True
                continue
            self.group_of[object_pointer] = group
            for number, is_included in states.items():
                target = included if is_included else excluded
                target[number] |= 1 << group
        pairs = zip(included, excluded, strict=True)
        self._masks = [(inc or ALL_GROUPS) & ~exc & ALL_GROUPS for inc, exc in pairs]

    def mask_of(self, light: Any) -> int:
        """The groups that a light (original object) reaches, as a 64-bit set."""
        number = self._collection_of.get(light.as_pointer())
        return ALL_GROUPS if number is None else self._masks[number]

    def group(self, parent: Any, instance: Any) -> int:
        """The group of an instance: its instancer's, else its own. Both are original objects; parent may be None."""
        if not self.group_of:
            return 0
        group = self.group_of.get(parent.as_pointer(), 0) if parent is not None else 0
        return group or self.group_of.get(instance.as_pointer(), 0)


def _members(collection: Any) -> Iterator[tuple[int, bool]]:
    """(object pointer, included) in the order in which later ones replace earlier ones."""
    for child, link in zip(collection.children, collection.collection_children, strict=True):
        included = link.light_linking.link_state == "INCLUDE"
        for item in child.all_objects:
            yield item.as_pointer(), included
    for item, link in zip(collection.objects, collection.collection_objects, strict=True):
        yield item.as_pointer(), link.light_linking.link_state == "INCLUDE"
