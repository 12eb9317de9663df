# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a square for each pixel: four lattices, each shifted by an offset of its own, whose means are independent
estimates."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

LATTICES = 4


def measure_lattice(count: int, step: int) -> int:
    """Square of the shortest vector of the lattice (i, i step) modulo `count`: Gauss's reduction."""
    one, other = (1, step), (0, count)
    while True:
        if one[0] ** 2 + one[1] ** 2 > other[0] ** 2 + other[1] ** 2:
            one, other = other, one
        square = one[0] ** 2 + one[1] ** 2
        times = round((one[0] * other[0] + one[1] * other[1]) / square)
        if times == 0:
            return square
        other = (other[0] - times * one[0], other[1] - times * one[1])


@cache
def find_lattice_step(count: int) -> int:
    """The step for which the points (i / count, i step / count) keep farthest apart, each of its own column and row."""
    steps = [step for step in range(1, max(count, 2)) if math.gcd(step, count) == 1]
    return max(steps, key=lambda step: measure_lattice(count, step))


def hash_bits(values: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Scatters the bits of 64-bit integers (the finaliser of SplitMix64)."""
    with np.errstate(over="ignore"):
        values = (values ^ (values >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        values = (values ^ (values >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return values ^ (values >> np.uint64(31))


class PixelSamples:
    """The samples of pixels, the same whenever a pixel with the same number asks. `count`: of all lattices."""

    def __init__(self, pixel: NDArray[np.integer], sample_count: int) -> None:
        self._of_lattice = max(1, math.ceil(sample_count / LATTICES))
        self.count = self._of_lattice * LATTICES
        index = np.arange(self._of_lattice)
        step = find_lattice_step(self._of_lattice)
        self._points = np.stack([index, index * step % self._of_lattice]) / self._of_lattice
        self._pixel = np.asarray(pixel).astype(np.uint64)

    def make(self, rows: NDArray[np.integer]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Both coordinates, -1/2 to 1/2, (rows, count): the lattices one after another."""
        pixels = self._pixel[rows]
        coordinates = []
        for axis in range(2):
            parts = []
            for lattice in range(LATTICES):
                with np.errstate(over="ignore"):
                    number = np.uint64(2 * lattice + axis + 1) * np.uint64(0x9E3779B97F4A7C15)
                    bits = hash_bits(pixels * np.uint64(0xD1342543DE82EF95) + number)
                shift = (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53
                parts.append((self._points[axis][None, :] + shift[:, None]) % 1.0 - 0.5)
            coordinates.append(np.concatenate(parts, axis=1))
        return coordinates[0], coordinates[1]
