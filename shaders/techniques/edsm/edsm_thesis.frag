// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Edge distance shadow mapping as [Kenzel13] 4.2.2 reads: one slope-biased depth for all four tests, and the sign of
// the bilinearly interpolated distance where they disagree. Kept to measure what the differences of edsm.frag are
// worth.
#include "stages/resolve_inputs.glsl"
#include "lib/edge_reconstruction_lib.glsl"
#include "shared/edge_map.h"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(binding = kEdgeMapUnit) uniform sampler2DArray edge_map_tx;
layout(location = 0) uniform float u_softness_texels;  // 0: hard
layout(location = 0) out float visibility;

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
    vec2 corner = floor(point.texel - 0.5);
    vec4 weights = bilinear_weights(point.texel - 0.5 - corner);
    float reference = max(point.depth_rz + point.rounding, 0.0);

    vec4 lit;
    float signed_distance = 0.0;
    for (int k = 0; k < 4; ++k) {
        vec2 centre = corner + 0.5 + kCorners[k];
        lit[k] = texture(depth_map_tx, vec4(centre * light.map.y, layer, reference));
        ivec2 texel = clamp(ivec2(centre), ivec2(0), ivec2(int(light.map.x) - 1));
        vec4 stored = texelFetch(edge_map_tx, ivec3(texel, max(layer, 0)), 0);
        signed_distance += weights[k] * (stored.w > kNoEdgeDepth ? stored.z : 0.0);
    }
    bool agree = lit.x == lit.y && lit.x == lit.z && lit.x == lit.w;
    float by_distance = u_softness_texels > 0.0 ? disc_kernel(signed_distance, u_softness_texels)
                                                : float(signed_distance > 0.0);
    visibility = combine_visibility(receiver, layer, agree ? lit.x : by_distance);
}
