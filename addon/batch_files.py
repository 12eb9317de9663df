# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files and progress of the batch. A file appears under its final name only when it is whole. No bpy."""

from __future__ import annotations

import contextlib
import json
import os
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .names import clean, short_hash

HEARTBEAT_S = 2.0
FORBIDDEN_IN_FILE_NAMES = '<>:"/\\|?* '
FILE_NAME_BYTES = 80
STALE_S = 24 * 3600.0
TEMPORARY_PREFIX = ".shadow-layers-"


class BatchError(Exception):
    """Something that was asked for can't be done; the text names the culprit and the remedy."""


def describe_os_error(error: OSError) -> str:
    return error.strerror or str(error)


def make_output_folder(folder: Path) -> Path:
    """Makes the folder and checks that it can be written to. Raises BatchError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise BatchError(
            f'the output folder "{folder}" can not be written to: {describe_os_error(error)}; '
            "choose another with --out, or free its disk"
        ) from error
    remove_stale_files(folder)
    return folder


def remove_stale_files(folder: Path) -> None:
    """What a run that was killed left behind more than a day ago."""
    for path in folder.glob(TEMPORARY_PREFIX + "*"):
        with contextlib.suppress(OSError):
            if path.is_file() and time.time() - path.stat().st_mtime > STALE_S:
                path.unlink()


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A temporary path beside `path`, with its suffix, to be written in the `with` block; renamed to `path` after it,
    removed on any error. OSErrors and an empty file become BatchErrors."""
    temporary = ""
    try:
        handle, temporary = tempfile.mkstemp(prefix=TEMPORARY_PREFIX, suffix=path.suffix, dir=path.parent)
        os.close(handle)
        yield Path(temporary)
        if os.path.getsize(temporary) == 0:
            raise BatchError(f'nothing was written for "{path}": free disk space, and see the messages above')
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(temporary, 0o666 & ~umask)  # mkstemp's 0600 would hide the file from others
        os.replace(temporary, path)
        temporary = ""
    except OSError as error:
        raise BatchError(
            f'"{path}" can not be written: {describe_os_error(error)}; choose another folder with --out, '
            "or free its disk"
        ) from error
    finally:
        if temporary:
            with contextlib.suppress(OSError):
                os.unlink(temporary)


def write_bytes(path: Path, data: bytes) -> None:
    """Writes a file whole. Raises BatchError."""
    with whole_file(path) as temporary, open(temporary, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def write_json(path: Path, document: Any) -> None:
    """Writes readable, strict JSON (no NaN)."""
    write_bytes(path, (json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode())


class FileNamer:
    """File names from the names of lights and techniques: readable, safe on every system, never twice the same."""

    def __init__(self) -> None:
        self._given: dict[str, str] = {}

    def make_name(self, *parts: str) -> str:
        """A name without suffix. The same parts give the same name again."""
        key = "\n".join(parts)
        safe = "".join(
            "_" if c in FORBIDDEN_IN_FILE_NAMES else c for c in clean("_".join(part for part in parts if part))
        )
        encoded = safe.encode("utf-8", "replace")
        if len(encoded) > FILE_NAME_BYTES:  # what is cut away may be all that tells two names apart
            cut = encoded[: FILE_NAME_BYTES - 5].decode("utf-8", "ignore")
            safe = f"{cut}_{short_hash(key)}"
        name = safe = safe.strip("_.") or "layer"
        while self._given.setdefault(name.casefold(), key) != key:
            name = f"{safe}_{short_hash(key + name)}"
        return name


class Progress:
    """Lines on standard output: each step as it begins, and every two seconds while it lasts. Blender's own chatter is
    kept back meanwhile, and shown if the step fails."""

    def __init__(self, verbose: bool = False) -> None:
        self._verbose = verbose
        self._out = os.fdopen(os.dup(1), "w", buffering=1, encoding="utf-8", errors="replace")

    def say(self, text: str) -> None:
        print(text, file=self._out, flush=True)

    @contextlib.contextmanager
    def step(self, text: str) -> Iterator[None]:
        """A step of the work."""
        self.say(text)
        done = threading.Event()
        beat = threading.Thread(target=self._beat, args=(text, done), daemon=True)
        beat.start()
        try:
            with contextlib.nullcontext() if self._verbose else self._chatter_kept():
                yield
        finally:
            done.set()
            beat.join()

    def _beat(self, text: str, done: threading.Event) -> None:
        start = time.monotonic()
        while not done.wait(HEARTBEAT_S):
            self.say(f"  ... {time.monotonic() - start:.0f} s: {text}")

    @contextlib.contextmanager
    def _chatter_kept(self) -> Iterator[None]:
        sys.stdout.flush()
        with tempfile.TemporaryFile() as log:
            saved = os.dup(1)
            os.dup2(log.fileno(), 1)
            try:
                yield
            except BaseException:
                sys.stdout.flush()
                log.seek(0)
                self.say(log.read().decode("utf-8", "replace").rstrip())
                raise
            finally:
                sys.stdout.flush()
                os.dup2(saved, 1)
                os.close(saved)
