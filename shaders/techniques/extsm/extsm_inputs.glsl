// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The maps of the resolve passes, and the four texels round a receiver in the order of kCorners: (0,0) (1,0) (0,1)
// (1,1).
#include "stages/resolve_inputs.glsl"
#include "lib/edge_reconstruction_lib.glsl"
#include "techniques/extsm/extended_map.h"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(binding = kEdgeMapUnit) uniform sampler2DArray edge_value_tx;
layout(binding = kEdgeDepthUnit) uniform sampler2DArray edge_depth_tx;
layout(location = 3) uniform float u_depth_sign;
layout(location = 0) out float visibility;

struct EdgeFootprint {
    vec4 values;
    vec4 depths_rz;
    bvec4 held;  // there is an edge
};

EdgeFootprint fetch_footprint(vec2 corner, int layer) {
    vec3 middle = vec3((corner + 1.0) * light.map.y, max(layer, 0));
    vec4 depths = textureGather(edge_depth_tx, middle).wzxy;
    return EdgeFootprint(textureGather(edge_value_tx, middle).wzxy, u_depth_sign * depths,
                         greaterThan(depths, vec4(kNoEdgeBound)));
}
