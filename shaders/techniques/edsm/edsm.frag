// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Edge distance shadow mapping: four depth tests; where they disagree, the distance to the silhouette edge decides.
// Defines: SOFT (1: a kernel over the distance instead of its sign).
// Based on: [Kenzel13] 4.2.2 and figure 6.1. Differences: docs/techniques/edsm.md.
#include "stages/resolve_inputs.glsl"
#include "techniques/edsm/edge_depth_lib.glsl"
#include "lib/edge_reconstruction_lib.glsl"
#include "shared/edge_map.h"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(binding = kEdgeMapUnit) uniform sampler2DArray edge_map_tx;
layout(location = 0) uniform float u_softness_texels;
layout(location = 1) uniform float u_missing_texels;  // distance of a texel that holds no edge, soft kernel only
layout(location = 0) out float visibility;

float test_texel(MapPoint point, int layer, vec2 centre) {
    return texture(depth_map_tx, vec4(centre * light.map.y, layer, reference_depth(point, centre - point.texel)));
}

#if SOFT
// The kernel looks past the footprint, where an edge may well be a silhouette and yet no border of this receiver's
// shadow: others may shade both its sides. A border is lit a texel outside of the edge and dark a texel inside.
bool is_border(EdgeTexel edge, vec2 centre, MapPoint point, int layer) {
    vec2 foot = centre - edge.normal * edge.distance;
    vec2 outside = floor(foot + edge.normal) + 0.5, inside = floor(foot - edge.normal) + 0.5;
    return test_texel(point, layer, outside) > 0.5 && test_texel(point, layer, inside) < 0.5;
}
#endif

// `receiver_depth`: encoded as the map's.
EdgeTexel fetch_edge(ivec2 texel, int layer, float receiver_depth) {
    ivec2 inside = clamp(texel, ivec2(0), ivec2(int(light.map.x) - 1));
    vec4 stored = texelFetch(edge_map_tx, ivec3(inside, max(layer, 0)), 0);
    return EdgeTexel(stored.xy, stored.z, stored.w * (1.0 + kEdgeDepthRounding) >= receiver_depth);
}

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
    vec2 corner = floor(point.texel - 0.5);
    vec2 at = point.texel - 0.5 - corner;

    vec4 lit;
    for (int k = 0; k < 4; ++k) lit[k] = test_texel(point, layer, corner + 0.5 + kCorners[k]);
    bool decided = receiver.fixed_visibility != kMapDecides;
    bool agree = lit.x == lit.y && lit.x == lit.z && lit.x == lit.w;
    // A software rasteriser executes both sides of a branch; only the trips of a loop can be saved, so that the four
    // texels are worked by a loop that has none where nothing is to decide.
#if SOFT
    int trips = decided ? 0 : 4;
#else
    int trips = decided || agree ? 0 : 4;
#endif
    float receiver_depth = encode_edge_depth(point.depth_rz, edge_depth_scale(light.lc_from_rel[max(layer, 0)]));
    vec4 weights = bilinear_weights(at);
    vec4 signs = 2.0 * lit - 1.0;
    BorderEstimate estimate = kNoEstimate;
    for (int k = 0; k < trips; ++k) {
        ivec2 offset = ivec2(k & 1, k >> 1);
        EdgeTexel texel = fetch_edge(ivec2(corner) + offset, layer, receiver_depth);
#if SOFT
        texel.relevant = texel.relevant && is_border(texel, corner + 0.5 + vec2(offset), point, layer);
#endif
        add_texel(estimate, texel, vec2(offset), weights[k], signs[k], signs, at, agree ? u_missing_texels : 0.5);
    }
#if SOFT
    float signed_distance = agree ? estimate.forced : border_distance(estimate);
    float from_map = disc_kernel(signed_distance, u_softness_texels);
#else
    float from_map = agree ? lit.x : float(border_distance(estimate) > 0.0);
#endif
    visibility = combine_visibility(receiver, layer, from_map);
}
