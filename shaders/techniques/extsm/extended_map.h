// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The extended shadow map: what its texels hold, and the quads that are drawn into it.
// Based on: [Bujnak04] 3.1, 4.1, 4.2.

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace shadow_layers {
using glm::vec4;
#endif

const int kExtendedQuadSlot = 0;  // shader storage binding
const int kEdgeDepthUnit = 4;     // beside kEdgeMapUnit, which holds the values

/// A silhouette edge in a map with the quad's direction out of the caster: ends in texels (x, y) and depth_rz (z);
/// outward step at the start (xy) and at the end (zw), of length 1 where nothing is foreshortened.
struct ExtendedQuad {
    vec4 start;
    vec4 end;
    vec4 outward;
};

// A coordinate runs over the quad from 0 inside the caster to 1 outside. The edge passes at a third, and a half lies
// half the diagonal of a texel outside of it, which makes the quad three diagonals wide: one inside, two outside.
const float kTexelDiagonal = 1.41421356f;
const float kEdgeCoordinate = 1.0f / 3.0f;
const float kShiftedCoordinate = 0.5f;
const float kQuadWidthTexels = 3.0f * kTexelDiagonal;
const float kShiftTexels = 0.5f * kTexelDiagonal;

// The stored value is 1 - coordinate: larger is deeper inside. A texel without an edge counts as this.
const float kNoEdgeValue = 0.75f;
// Cleared edge depth, and a bound: what is stored for an edge (depth_rz or its negative) lies above it.
const float kNoEdgeClear = -2.0f;
const float kNoEdgeBound = -1.5f;

#ifdef __cplusplus
static_assert(sizeof(ExtendedQuad) == 48, "std430 layout");
}  // namespace shadow_layers
#endif
