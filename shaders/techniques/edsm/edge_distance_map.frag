// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What a texel keeps of the edge, if the edge is seen from the light. The depth buffer sorts: smallest priority wins.
// Defines: EDGE_ORDER (lib/edge_lib.glsl), OWN_TEXEL_TEST (1: the thesis's test of the edge against one texel).
// Based on: [Kenzel13] 4.2.1.
#include "techniques/edsm/edge_depth_lib.glsl"
#include "lib/edge_lib.glsl"
#include "shared/edge_map.h"
#include "shared/light_params.h"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(location = 0) uniform float u_half_width_texels;
layout(location = 1) uniform float u_size_texels;
layout(location = 2) uniform int u_layer;
layout(location = 3) uniform float u_depth_scale;

flat in vec3 edge_start;
flat in vec3 edge_end;
layout(location = 0) out vec4 edge_texel;

// Rounding of an edge's depth against the map's: some units in the last place of numbers up to 1.
const float kDepthRounding = 1.0 / 1048576.0;

void main() {
    EdgeSample edge = sample_edge(gl_FragCoord.xy, edge_start.xy, edge_end.xy);
    vec2 foot = mix(edge_start.xy, edge_end.xy, edge.fraction);
    float depth_rz = mix(edge_start.z, edge_end.z, edge.fraction);
#if OWN_TEXEL_TEST
    float seen = texture(depth_map_tx, vec4(gl_FragCoord.xy / u_size_texels, u_layer, depth_rz + kDepthRounding));
#else
    // Seen if it lies before the farthest of the four depths round its foot: one side of an outline is background.
    vec4 tests = textureGather(depth_map_tx, vec3(foot / u_size_texels, u_layer), depth_rz + kDepthRounding);
    float seen = max(max(tests.x, tests.y), max(tests.z, tests.w));
#endif
    if (seen <= 0.0) discard;
    // Seen from the light the caster is on the left of the edge (scene/silhouettes.h), where edge.normal points.
    edge_texel = vec4(-edge.normal, -edge.line_distance, encode_edge_depth(depth_rz, u_depth_scale));
    // Distances on a quad are below 2 reach; a cosine is at most 1.
    gl_FragDepth = edge_priority(EDGE_ORDER, edge) / (4.0 * u_half_width_texels + 2.0);
}
