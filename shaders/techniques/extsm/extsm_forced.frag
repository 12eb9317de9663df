// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Extended shadow maps with the signs forced by depth tests in the receiver's plane: where the four tests disagree, the
// stored distances say where between the texels the border runs, without a shift.
#include "techniques/extsm/extsm_inputs.glsl"

layout(location = 4) uniform float u_half_width_texels;

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
    vec2 corner = floor(point.texel - 0.5);
    vec4 lit;
    for (int k = 0; k < 4; ++k) {
        vec2 centre = corner + 0.5 + kCorners[k];
        lit[k] = texture(depth_map_tx,
                         vec4(centre * light.map.y, layer, reference_depth(point, centre - point.texel)));
    }
    EdgeFootprint edges = fetch_footprint(corner, layer);
    bvec4 before = greaterThanEqual(edges.depths_rz, vec4(point.depth_rz - point.rounding));
    // Without an edge before the receiver the border runs midway between texels that disagree.
    vec4 distances = mix(vec4(0.5), (1.0 - edges.values) * u_half_width_texels,
                         bvec4(uvec4(edges.held) & uvec4(before)));
    float signed_distance = dot(bilinear_weights(point.texel - 0.5 - corner), (2.0 * lit - 1.0) * distances);
    bool agree = lit.x == lit.y && lit.x == lit.z && lit.x == lit.w;
    visibility = combine_visibility(receiver, layer, agree ? lit.x : float(signed_distance > 0.0));
}
