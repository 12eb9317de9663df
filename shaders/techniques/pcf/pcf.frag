// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Percentage-closer filtering: the mean of k x k depth tests round the receiver.
// Defines: KERNEL (taps per side), BILINEAR (0, 1: each tap weighs its four texels), EARLY_OUT (0, 1: no taps where the
// range map says that they all agree).
// Based on: [Reeves87]. Differences: taps on a regular grid instead of jittered ones; each tap is compared with the
// depth of the receiver's own plane at that tap.
#include "stages/resolve_inputs.glsl"
#if EARLY_OUT
#include "stages/depth_range.glsl"
#endif

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(location = 0) uniform float u_spacing_texels;
layout(location = 1) uniform float u_radius_texels;
layout(location = 0) out float visibility;

float test_texel(MapPoint point, int layer, vec2 centre) {
    return texture(depth_map_tx, vec4(centre * light.map.y, layer, reference_depth(point, centre - point.texel)));
}

// Precise: the window of the early-out and the taps round alike.
vec2 place_tap(MapPoint point, ivec2 index) {
    precise vec2 tap = point.texel + (vec2(index) - 0.5 * float(KERNEL - 1)) * u_spacing_texels;
    return tap;
}

// A tap's texel; with BILINEAR the lowest of its four.
vec2 first_texel(vec2 tap) {
#if BILINEAR
    return floor(tap - 0.5);
#else
    return floor(tap);
#endif
}

float test_tap(MapPoint point, int layer, vec2 tap) {
    vec2 corner = first_texel(tap) + 0.5;
#if BILINEAR
    vec2 at = tap - corner;
    float low = mix(test_texel(point, layer, corner), test_texel(point, layer, corner + vec2(1, 0)), at.x);
    float high =
        mix(test_texel(point, layer, corner + vec2(0, 1)), test_texel(point, layer, corner + vec2(1, 1)), at.x);
    return mix(low, high, at.y);
#else
    return test_texel(point, layer, corner);
#endif
}

#if EARLY_OUT
float decide_kernel(MapPoint point, int layer) {
    vec2 first = first_texel(place_tap(point, ivec2(0)));
    vec2 last = first_texel(place_tap(point, ivec2(KERNEL - 1))) + float(BILINEAR);
    return decide_taps(point, layer, first, last, u_radius_texels);
}
#endif

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
#if EARLY_OUT
    float decided = decide_kernel(point, layer);
#else
    const float decided = -1.0;
#endif
    // A software rasteriser masks branches but leaves a loop without trips.
    int rows = receiver.fixed_visibility == kMapDecides && decided < 0.0 ? KERNEL : 0;
    float sum = max(decided, 0.0) * float(KERNEL * KERNEL);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < KERNEL; ++x) sum += test_tap(point, layer, place_tap(point, ivec2(x, y)));
    // A quotient of equal numbers may miss 1 by a rounding.
    float from_map = sum == float(KERNEL * KERNEL) ? 1.0 : sum / float(KERNEL * KERNEL);
    visibility = combine_visibility(receiver, layer, from_map);
}
