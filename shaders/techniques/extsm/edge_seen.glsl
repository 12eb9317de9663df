// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// An edge is seen by the light if it lies before the farthest of the four depths round its foot point: beyond an
// outline is background. [Bujnak04] 3.1 biases the quads over a long distance instead, by an amount it doesn't tell.
#include "shared/light_params.h"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(location = 1) uniform float u_size_texels;
layout(location = 2) uniform int u_layer;

// Rounding of an edge's depth against the map's: some units in the last place of numbers up to 1.
const float kEdgeRounding = 1.0 / 1048576.0;

bool is_edge_seen(vec3 foot) {
    vec4 tests = textureGather(depth_map_tx, vec3(foot.xy / u_size_texels, u_layer), foot.z + kEdgeRounding);
    return any(greaterThan(tests, vec4(0.0)));
}
