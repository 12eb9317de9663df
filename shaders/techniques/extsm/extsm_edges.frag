// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What a texel keeps of an edge in the "forced" reading: closeness to the edge's segment, and the edge's depth.
// Blended as in extsm_quads.frag; the maximum is the nearest edge.
#include "techniques/extsm/edge_seen.glsl"
#include "lib/edge_lib.glsl"

layout(location = 0) uniform float u_half_width_texels;
layout(location = 3) uniform float u_depth_sign;

flat in vec3 edge_start;
flat in vec3 edge_end;
layout(location = 0) out float edge_value;
layout(location = 1) out float edge_depth;

void main() {
    EdgeSample edge = sample_edge(gl_FragCoord.xy, edge_start.xy, edge_end.xy);
    vec3 foot = mix(edge_start, edge_end, edge.fraction);
    if (edge.segment_distance > u_half_width_texels || !is_edge_seen(foot)) discard;
    edge_value = 1.0 - edge.segment_distance / u_half_width_texels;
    edge_depth = u_depth_sign * foot.z;
}
