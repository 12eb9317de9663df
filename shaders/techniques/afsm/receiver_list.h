// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Receivers listed by the texels of a light view, and casters that are drawn over them. Compiled by C++ and by GLSL.

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace shadow_layers {
using glm::ivec4;
using glm::vec4;
using uint = std::uint32_t;
#endif

const int kListReceiversSlot = 0;  // shader storage bindings
const int kListNextSlot = 1;
const int kListBlockedSlot = 2;
const int kListCastersSlot = 3;
const int kListCountsSlot = 4;
const int kListOpenSlot = 5;
const int kListHeadUnit = 0;  // image units
const int kListFarthestUnit = 1;

const uint kListEnd = 0u;  // links are a receiver's number plus 1: lanes that are off read 0, and must not walk on
const uint kNoReceiver = 0xFFFFFFFFu;  // bits above those of every depth
const int kInsertGroup = 64;           // threads

// A receiver is in one list only, so its number is the node's.
struct ListReceiver {
    float x, y;         // from the middle of its texel, in texels
    float depth;        // depth_rz
    float place_error;  // bound of how far off x, y may be
    float depth_error;
    uint texel;               // row * side + column
    uint instance, triangle;  // that it lies on
};

// value(u, v) = x + y * u + z * v, with u, v in texels from the middle of the texel in the middle of `rect`; w: bound
// of x's error.
struct ListCaster {
    vec4 edges[3];  // >= 0 inside
    vec4 depth;     // depth_rz of the triangle's plane
    ivec4 rect;     // texels that it may touch: first column and row, behind the last column and row
    uint instance, triangle;
    float top;  // greatest depth_rz, in [0, 1], rounded up
    uint unused;
};

struct ListCounts {
    uint open_pairs;  // as many as were found, also where they did not fit
    uint tests_low, tests_high;
    uint unused;
};

#ifdef __cplusplus
static_assert(sizeof(ListReceiver) == 32 && sizeof(ListCaster) == 96 && sizeof(ListCounts) == 16, "std430 layout");
}  // namespace shadow_layers
#endif
