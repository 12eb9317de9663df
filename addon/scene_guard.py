# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes to Blender's data that are undone, whatever happens in between."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any


class SceneGuard:
    """Remembers what it changes and makes; leaving the `with` block puts everything back, last change first.

    Undoing goes on past an error, so that one lost datablock doesn't leave the rest changed; the first such error is
    raised at the end, unless another exception is already on its way.
    """

    def __init__(self) -> None:
        self._undo: list[Callable[[], None]] = []

    def __enter__(self) -> SceneGuard:
        return self

    def __exit__(self, error_type: type | None, *_: object) -> None:
        first_error: Exception | None = None
        while self._undo:
            try:
                self._undo.pop()()
            except Exception as error:
                first_error = first_error or error
        if first_error is not None and error_type is None:
            raise first_error

    def set(self, owner: Any, name: str, value: Any) -> None:
        """Sets a property, unless it has that value already."""
        old = getattr(owner, name)
        if old == value:
            return
        setattr(owner, name, value)
        self._undo.append(lambda: setattr(owner, name, old))

    def set_if_there(self, owner: Any, name: str, value: Any) -> bool:
        """As `set`, where the property exists in this version of Blender. Returns whether it does."""
        if owner is None or not hasattr(owner, name):
            return False
        self.set(owner, name, value)
        return True

    def made(self, collection: Any, datablock: Any) -> Any:
        """Registers a datablock that is to be removed from its collection (`bpy.data.lights`, ...) at the end."""

        def remove() -> None:
            # Already gone when something else removed it: nothing to undo.
            with contextlib.suppress(ReferenceError):
                collection.remove(datablock)

        self._undo.append(remove)
        return datablock

    def on_exit(self, undo: Callable[[], None]) -> None:
        """Registers any other step of the undoing."""
        self._undo.append(undo)
