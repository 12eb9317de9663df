// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The code of a map texel: its own depth test, and the sides where a neighbour's differs. [Macedo16] 3.1 packs the same
// into three numbers, d_c.

const uint kLeft = 1u;     // -x; bits of a code: sides where the neighbour's test differs
const uint kRight = 2u;    // +x
const uint kTop = 4u;      // -y: the names of [Macedo16]
const uint kBottom = 8u;   // +y
const uint kSidesX = 3u;
const uint kSidesY = 12u;
const uint kAllSides = 15u;
const uint kLitTexel = 16u;  // bit: the texel's own test

bool has_all(uint code, uint sides) { return (code & sides) == sides; }
bool has_any(uint code, uint sides) { return (code & sides) != 0u; }

// A set of sides is gone through by its lowest bit.
uint lowest(uint sides) { return sides & (~sides + 1u); }
ivec2 step_over(uint side) {
    return ivec2(int(side == kRight) - int(side == kLeft), int(side == kBottom) - int(side == kTop));
}
