// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Edge distance shadow mapping: four depth tests; where they disagree, the distance to the silhouette edge decides.
// Defines: SOFT (1: a kernel over the distance instead of its sign).
// Based on: [Kenzel13] 4.2.2 and figure 6.1. Differences: docs/techniques/edsm.md.
#include "stages/resolve_inputs.glsl"
#include "lib/edge_reconstruction_lib.glsl"
#include "shared/edge_map.h"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(binding = kEdgeMapUnit) uniform sampler2DArray edge_map_tx;
layout(location = 0) uniform float u_softness_texels;
layout(location = 1) uniform float u_missing_texels;  // distance of a texel that holds no edge, soft kernel only
layout(location = 0) out float visibility;

EdgeTexel fetch_edge(ivec2 texel, int layer, float depth_rz) {
    ivec2 inside = clamp(texel, ivec2(0), ivec2(int(light.map.x) - 1));
    vec4 stored = texelFetch(edge_map_tx, ivec3(inside, max(layer, 0)), 0);
    return EdgeTexel(stored.xy, stored.z, stored.w >= depth_rz);
}

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
    vec2 corner = floor(point.texel - 0.5);
    vec2 at = point.texel - 0.5 - corner;

    vec4 lit;
    for (int k = 0; k < 4; ++k) {
        vec2 centre = corner + 0.5 + kCorners[k];
        lit[k] = texture(depth_map_tx, vec4(centre * light.map.y, layer, reference_depth(point, centre - point.texel)));
    }
    float from_map = lit.x;
    bool decided = receiver.fixed_visibility != kMapDecides;
    bool agree = lit.x == lit.y && lit.x == lit.z && lit.x == lit.w;
    // A software rasteriser masks branches but leaves a loop without trips.
#if SOFT
    int rounds = decided ? 0 : 1;
#else
    int rounds = decided || agree ? 0 : 1;
#endif
    for (int round = 0; round < rounds; ++round) {
        EdgeTexel texels[4];
        for (int k = 0; k < 4; ++k) texels[k] = fetch_edge(ivec2(corner) + ivec2(kCorners[k]), layer, point.depth_rz);
        float signed_distance;
        bool by_line = !agree && agreeing_line_distance(at, lit, texels, signed_distance);
        if (!by_line) signed_distance = sign_forced_distance(at, lit, texels, agree ? u_missing_texels : 0.5);
#if SOFT
        from_map = disc_kernel(signed_distance, u_softness_texels);
#else
        from_map = signed_distance > 0.0 ? 1.0 : 0.0;
#endif
    }
    visibility = combine_visibility(receiver, layer, from_map);
}
