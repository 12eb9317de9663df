# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered truth on disk, by content key: bounded in bytes, whole files only. NumPy only."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import tempfile
import time
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

DEFAULT_LIMIT_BYTES = 2 << 30
PARTIAL_PREFIX = ".partial-"
PARTIAL_LIFE_S = 3600.0


def get_default_folder() -> Path:
    """The user's cache folder for truth, by the platform's custom."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = str(Path.home() / "Library" / "Caches")
    else:
        base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "shadow-layers" / "truth"


def compute_key(*parts: Any) -> str:
    """Hexadecimal content key of arrays (dtype, shape and bytes count) and of anything that JSON can hold."""
    digest = hashlib.blake2b(digest_size=16)
    for part in parts:
        if isinstance(part, np.ndarray):
            header = f"array {part.dtype.str} {part.shape}"
            payload: Any = np.ascontiguousarray(part).reshape(-1).view(np.uint8).data
        else:
            header = "json"
            payload = json.dumps(part, sort_keys=True).encode()
        digest.update(f"{header} {len(payload)}\n".encode())
        digest.update(payload)
    return digest.hexdigest()


class TruthCache:
    """Arrays by key, one .npz file each. The files used longest ago go first once `limit_bytes` is exceeded.

    A cache must never be the reason that a comparison fails: what can't be read counts as missing, and what can't be
    written is left out (`last_error` says why).
    """

    def __init__(self, folder: Path | str | None = None, limit_bytes: int = DEFAULT_LIMIT_BYTES) -> None:
        self.folder = Path(folder) if folder is not None else get_default_folder()
        self.limit_bytes = limit_bytes
        self.last_error = ""

    def _get_path(self, key: str) -> Path:
        return self.folder / f"{key}.npz"

    def load(self, key: str) -> dict[str, NDArray[Any]] | None:
        """The arrays stored under `key`, or None."""
        path = self._get_path(key)
        try:
            with np.load(path, allow_pickle=False) as archive:
                arrays = {name: archive[name] for name in archive.files}
            os.utime(path)
        except FileNotFoundError:
            return None
        except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile) as error:
            self.last_error = f"{path} is unreadable ({error}); it is rendered again"
            with contextlib.suppress(OSError):
                path.unlink()
            return None
        return arrays

    def store(self, key: str, arrays: Mapping[str, NDArray[Any]]) -> bool:
        """Writes under a temporary name, then renames: no reader ever meets half a file. False: not stored."""
        handle = -1
        temporary = ""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(prefix=PARTIAL_PREFIX, suffix=".npz", dir=self.folder)
            with os.fdopen(handle, "wb") as file:
                np.savez_compressed(file, **arrays)
            os.replace(temporary, self._get_path(key))
        except OSError as error:
            self.last_error = f"truth isn't cached in {self.folder}: {error}"
            if temporary:
                with contextlib.suppress(OSError):
                    os.unlink(temporary)
            return False
        self.trim(keep=key)
        return True

    def trim(self, keep: str = "") -> None:
        """Removes the files used longest ago until the rest fits; never the one under `keep`."""
        entries = []
        with contextlib.suppress(OSError):
            for path in self.folder.glob("*.npz"):
                with contextlib.suppress(OSError):
                    status = path.stat()
                    if not path.name.startswith(PARTIAL_PREFIX):
                        entries.append((status.st_mtime_ns, status.st_size, path))
                    elif time.time() - status.st_mtime > PARTIAL_LIFE_S:
                        path.unlink()  # of a run that was killed
        total = sum(size for _, size, _ in entries)
        for _, size, path in sorted(entries, key=lambda entry: entry[0]):
            if total <= self.limit_bytes:
                break
            if path == self._get_path(keep):
                continue
            with contextlib.suppress(OSError):
                path.unlink()
                total -= size
