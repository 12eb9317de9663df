// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The edge distance map: how edges come in and what a texel holds.

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace shadow_layers {
using glm::vec4;
#endif

const int kEdgeListSlot = 0;  // shader storage binding

/// An edge in a map: ends in texels (x, y), depth_rz (z), and how much its quad widens there (w).
struct MapEdge {
    vec4 start;
    vec4 end;
};

// Texel of the edge distance map (RGBA16F): unit normal of the nearest edge's line (towards its lit side), signed
// distance of the texel's centre along it in texels, depth of the edge at its nearest point (shaders/lib/
// edge_depth_lib.glsl). The clear value lies behind all. Half floats put a border within 1/500 texel of where it
// belongs, at half the memory traffic.
const float kNoEdgeDepth = -1.0f;
const float kGreatestEdgeDepth = 60000.0f;        // half floats end at 65504
const float kEdgeDepthRounding = 1.0f / 1024.0f;  // relative, of a depth in a half float, with some room

#ifdef __cplusplus
static_assert(sizeof(MapEdge) == 32, "std430 layout");
}  // namespace shadow_layers
#endif
