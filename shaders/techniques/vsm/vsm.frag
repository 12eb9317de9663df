// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Variance shadow mapping: Chebyshev's bound on the part of the footprint that does not block.
// Defines: FIXED_POINT (1: 16 bits), those of stages/moment_inputs.glsl.
// Based on: [Donnelly06], light bleeding [Lauritzen08]. Differences: docs/techniques/vsm.md.
#include "stages/moment_inputs.glsl"
#include "lib/moment_lib.glsl"

layout(location = 8) uniform float u_bleed_reduction;
layout(location = 0) out float visibility;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Receiver receiver = fetch_receiver(pixel);
    int layer = choose_layer(receiver);
    FilteredReceiver filtered = filter_receiver(pixel, receiver, layer, locate_in_map(receiver, layer));
#if FIXED_POINT
    vec2 moments = decode_variance_fixed(filtered.moments.xy);
#else
    vec2 moments = filtered.moments.xy;
#endif
    // The mean and its square are each rounded a few times; their difference has that error and none smaller. The
    // plane's own variance needs no floor: it is in the map, where the plane is.
    float rounding = 4.0 * u_unit_roundoff;
    // Where it ends at the far plane its mean lies too near, by no more than the deviation that is measured.
    float variance = max(moments.y - moments.x * moments.x, 0.0);
    float bias = min(filtered.cut_off, sqrt(variance)) + rounding;
    float lit = chebyshev_bound(moments.x, moments.y, filtered.depth - bias, rounding);
    visibility = combine_visibility(receiver, layer, reduce_bleeding(lit, u_bleed_reduction));
}
