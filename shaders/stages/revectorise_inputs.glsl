// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A fragment that is to be revectorised: its receiver, its texel, and the depth test of any texel round it.
// Defines: FOLLOW_SLOPE (1: each texel is compared in the receiver's own plane; 0: all with one depth, [Macedo16] 3.1).
#include "stages/resolve_inputs.glsl"
#include "lib/revectorisation_lib.glsl"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(location = 0) uniform int u_walk_limit;

struct Fragment {
    Receiver receiver;
    MapPoint point;
    int layer;
    ivec2 texel;
    vec2 place;  // within the texel, 0..1
};

Fragment fragment;

void fetch_fragment(ivec2 pixel) {
    fragment.receiver = fetch_receiver(pixel);
    fragment.layer = choose_layer(fragment.receiver);
    fragment.point = locate_in_map(fragment.receiver, fragment.layer);
    vec2 corner = floor(fragment.point.texel);
    fragment.texel = ivec2(corner);
    fragment.place = fragment.point.texel - corner;
}

// The receiver's plane, by the rule of reference_depth round the fragment, so that its own texel's test is that of sm.
// Walks go farther: where the plane falls away from the light it is followed too, but a texel and a half behind. Kept
// back, a walk down a slope would leave the shadow of a near caster; followed closely, fine meshes would shade
// themselves (docs/techniques/smsr.md has the figures).
// One depth for all has to hold for the neighbours' centres at least: they are up to 3/2 texels away on one axis.
const float kLagTexels = 1.5;

float reference_at(vec2 centre) {
    vec2 offset = centre - fragment.point.texel;
    vec2 slope = fragment.point.gradient;
#if FOLLOW_SLOPE
    float rise = dot(slope, offset);
    float reach = max(max(abs(offset.x), abs(offset.y)), kLagTexels);
    rise = max(rise, rise * (1.0 - kLagTexels / reach));
#else
    float rise = 0.5 * (abs(slope.x) + abs(slope.y)) + max(abs(slope.x), abs(slope.y));
#endif
    return max(fragment.point.depth_rz + rise + fragment.point.rounding, 0.0);
}

float test_texel(vec2 centre) {
    return texture(depth_map_tx, vec4(centre * light.map.y, fragment.layer, reference_at(centre)));
}

bool is_texel_lit(ivec2 texel) { return test_texel(vec2(texel) + 0.5) > 0.5; }

// The code of the fragment's own texel, as tested; without loops, for programs that run over all pixels.
uint look_at_own_texel() {
    vec2 centre = vec2(fragment.texel) + 0.5;
    float own = test_texel(centre);
    bvec4 open = notEqual(vec4(own), vec4(test_texel(centre - vec2(1, 0)), test_texel(centre + vec2(1, 0)),
                                          test_texel(centre - vec2(0, 1)), test_texel(centre + vec2(0, 1))));
    return (own > 0.5 ? kLitTexel : 0u) | (open.x ? kLeft : 0u) | (open.y ? kRight : 0u) | (open.z ? kTop : 0u) |
           (open.w ? kBottom : 0u);
}

// Does a walk have a say? `exiting`: for texels in shadow too.
bool needs_walk(uint code, bool exiting) {
    bool map_decides = fragment.receiver.fixed_visibility == kMapDecides && fragment.layer >= 0;
    return map_decides && has_any(code, kAllSides) && (exiting || has_any(code, kLitTexel));
}

float combine_with_texel(uint code) {
    return combine_visibility(fragment.receiver, fragment.layer, has_any(code, kLitTexel) ? 1.0 : 0.0);
}
