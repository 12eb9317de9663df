// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Percentage-closer filtering: the mean of k x k depth tests round the receiver.
// Defines: KERNEL (taps per side, odd), BILINEAR (0, 1: each tap weighs its four texels).
// Based on: [Reeves87]. Differences: taps on a regular grid instead of jittered ones; each tap is compared with the
// depth of the receiver's own plane at that tap.
#include "stages/resolve_inputs.glsl"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(location = 0) uniform float u_spacing_texels;
layout(location = 0) out float visibility;

float test_texel(MapPoint point, int layer, vec2 centre) {
    return texture(depth_map_tx, vec4(centre * light.map.y, layer, reference_depth(point, centre - point.texel)));
}

float test_tap(MapPoint point, int layer, vec2 tap) {
#if BILINEAR
    vec2 corner = floor(tap - 0.5) + 0.5;
    vec2 at = tap - corner;
    float low = mix(test_texel(point, layer, corner), test_texel(point, layer, corner + vec2(1, 0)), at.x);
    float high =
        mix(test_texel(point, layer, corner + vec2(0, 1)), test_texel(point, layer, corner + vec2(1, 1)), at.x);
    return mix(low, high, at.y);
#else
    return test_texel(point, layer, floor(tap) + 0.5);
#endif
}

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
    // A software rasteriser masks branches but leaves a loop without trips.
    int rows = receiver.fixed_visibility == kMapDecides ? KERNEL : 0;
    float sum = 0.0;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < KERNEL; ++x) {
            vec2 offset = (vec2(x, y) - 0.5 * float(KERNEL - 1)) * u_spacing_texels;
            sum += test_tap(point, layer, point.texel + offset);
        }
    visibility = combine_visibility(receiver, layer, sum / float(KERNEL * KERNEL));
}
