// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Moment shadow mapping: the least part of the footprint that blocks, by four moments of its depths (Hamburger).
// Defines: FIXED_POINT (1: 16 bits, the moments packed), those of stages/moment_inputs.glsl.
// Based on: [Peters15], [Peters17]. Differences: docs/techniques/msm.md.
#include "stages/moment_inputs.glsl"
#include "lib/moment_lib.glsl"

layout(location = 8) uniform float u_moment_bias;
layout(location = 9) uniform float u_bleed_reduction;
layout(location = 0) out float visibility;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Receiver receiver = fetch_receiver(pixel);
    int layer = choose_layer(receiver);
    FilteredReceiver filtered = filter_receiver(pixel, receiver, layer, locate_in_map(receiver, layer));
#if FIXED_POINT
    vec4 moments = unpack_moments(filtered.moments);
#else
    vec4 moments = filtered.moments;
#endif
    // The bound is 0 where the depth lies before both nodes of Gauss's rule of two points, which for a plane under a
    // symmetric kernel are a standard deviation before and behind its middle. Twice the map's own deviation is enough
    // where the plane is bent; more would let a receiver that the light grazes see through casters.
    float measured = max(moments.y - moments.x * moments.x, 0.0);
    float bias = min(sqrt(filtered.variance) + 2.0 * filtered.cut_off, filtered.largest_rise);
    bias = min(bias, 2.0 * sqrt(measured));
    float depth = filtered.depth - bias - 4.0 * u_unit_roundoff;
    float blocked = block_bound(moments, depth, u_moment_bias);
    visibility = combine_visibility(receiver, layer, 1.0 - min(blocked / (1.0 - u_bleed_reduction), 1.0));
}
