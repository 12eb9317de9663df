// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A line of up to 29 texels as the bits of a number. Shifts by other than constants are slow where a processor has none
// for whole vectors: powers of two go by way of the exponents of floats, and runs of bits are found by carries.

const int kMostBits = 29;

// 2^place, of a place from 0 to kMostBits.
uint bit_at(int place) { return uint(int(intBitsToFloat((place + 127) << 23))); }

// The place of a lone bit.
int place_of(uint bit) { return (floatBitsToInt(float(int(bit))) >> 23) - 127; }

// Bits `low` to `high`, inclusive; none if high < low. Both may lie outside of the line.
uint bits_between(int low, int high) {
    int from = clamp(low, 0, kMostBits), end = clamp(high + 1, from, kMostBits);
    return bit_at(end) - bit_at(from);
}

uint lowest_bit(uint bits) { return bits & (~bits + 1u); }

// The unbroken run of set bits that begins at `first`, a lone bit, and the bit after it: adding carries over the run.
uint run_from(uint bits, uint first) { return bits & ~(bits + first); }
uint bit_after_run(uint bits, uint first) { return lowest_bit((bits + first) & ~bits & ~(first - 1u)); }

// Bits of runs that have more than one.
uint longer_than_one(uint bits) { return bits & ((bits << 1) | (bits >> 1)); }

int sum_of_places(uint bits) {
    return bitCount(bits & 0xaaaaaaaau) + 2 * bitCount(bits & 0xccccccccu) + 4 * bitCount(bits & 0xf0f0f0f0u) +
           8 * bitCount(bits & 0xff00ff00u) + 16 * bitCount(bits & 0xffff0000u);
}
