# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bytes that this process holds, and by how much they grow over an animation that comes again and again.

Resident memory as the system tells it can't find a small leak: jemalloc (Debian's Blender) gives freed pages back by
the clock, glibc (the modules) where whole pages happen to be free: tens of megabytes from frame to frame. So the
allocator is asked what was allocated and not freed; resident memory is read after it has given back what it can.
"""

import ctypes
import gc
from collections.abc import Sequence
from pathlib import Path

import numpy as np

_libc = ctypes.CDLL(None)
_kAllArenas = b"arena.4096"  # MALLCTL_ARENAS_ALL of jemalloc 5

# What may seem to grow over the distance of compute_growth without a leak: allocators' own books, and pages that hold a
# little each. The core counts what it holds; that must not grow at all.
kGrowthBounds = {"allocated": 500_000, "resident": 2_500_000, "host": 0, "gpu": 0}


class _MallInfo(ctypes.Structure):
    """struct mallinfo2 of glibc: ten numbers."""

    _fields_ = [("others", ctypes.c_size_t * 4), ("mapped", ctypes.c_size_t), ("unused", ctypes.c_size_t * 2),
                ("in_arenas", ctypes.c_size_t), ("free", ctypes.c_size_t), ("top", ctypes.c_size_t)]  # fmt: skip


def allocator_name() -> str:
    """Whose `malloc` this process calls."""
    return "jemalloc" if hasattr(_libc, "mallctl") else "glibc"


def _control(name: bytes, new: int | None = None) -> int:
    """A number of jemalloc's, of 64 bits; `new` is written where it is given."""
    value, size = ctypes.c_uint64(new or 0), ctypes.c_size_t(8)
    given = (ctypes.byref(value), size) if new is not None else (None, ctypes.c_size_t(0))
    code = _libc.mallctl(name, ctypes.byref(value), ctypes.byref(size), *given)
    if code:
        raise OSError(code, f"jemalloc does not tell {name.decode()}")
    return value.value


def read_allocated() -> int:
    """Bytes that were allocated and not freed, by all threads."""
    if allocator_name() == "jemalloc":
        _control(b"epoch", new=1)  # statistics are as of the last one
        return _control(b"stats.allocated")
    _libc.mallinfo2.restype = _MallInfo
    info = _libc.mallinfo2()
    return info.in_arenas + info.mapped


def give_back() -> None:
    """Lets the allocator hand pages that nothing uses back to the system."""
    if allocator_name() == "jemalloc":
        nothing = (None, None, None, ctypes.c_size_t(0))
        if _libc.mallctl(_kAllArenas + b".purge", *nothing):
            raise OSError("jemalloc does not purge its arenas")
    else:
        _libc.malloc_trim(ctypes.c_size_t(0))


def read_resident() -> int:
    """Bytes of memory that is no file's: what was allocated, mapped by a driver or compiler, or lies on a stack."""
    # Unlike /proc/self/statm, which the kernel lets lag behind by some pages for each processor, this counts pages.
    lines = Path("/proc/self/smaps_rollup").read_text(encoding="ascii").splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("Anonymous:"))


def read_memory() -> dict[str, int]:
    """{"allocated": bytes, "resident": bytes} without what only waits to be collected or given back."""
    gc.collect()
    give_back()
    return {"allocated": read_allocated(), "resident": read_resident()}


def compute_growth(values: Sequence[float], settle: int, period: int) -> float:
    """By how much `values` grew over growth_distance frames: after `settle` frames an animation of `period` frames runs
    an even number of times. Of each of its frames the least in the later half of the runs is held against the least in
    the earlier half, so that a moment in which more is held does not count, and the median of these is taken. A leak
    of so much a frame shows as that times the distance."""
    half = growth_distance(len(values), settle, period) // period
    runs = np.asarray(values[settle : settle + 2 * half * period], float).reshape(2, half, period)
    earlier, later = runs.min(axis=1)
    return float(np.median(later - earlier))


def growth_distance(count: int, settle: int, period: int) -> int:
    """Frames between the two halves that compute_growth compares."""
    half = (count - settle) // (2 * period)
    if half < 1:
        raise ValueError(f"{count} frames hold less than two periods of {period} after {settle}")
    return half * period
