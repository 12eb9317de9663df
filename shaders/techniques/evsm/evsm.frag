// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exponential variance shadow mapping: Chebyshev's bound on depths warped by exp(c z), and with four components on
// those warped by -exp(-c z) too; the lower of the two holds.
// Defines: COMPONENTS (2, 4), those of stages/moment_inputs.glsl.
// Based on: [Lauritzen08] 4. Differences: docs/techniques/evsm.md.
#include "stages/moment_inputs.glsl"
#include "lib/moment_lib.glsl"

layout(location = 8) uniform vec2 u_exponents;
layout(location = 9) uniform float u_bleed_reduction;
layout(location = 0) out float visibility;

// `slope` of the warp: a depth's variance is that much wider after it, squared.
float bound_warped(vec2 moments, float warped, float slope, float depth_variance) {
    // The square and the mean's square each carry a few roundings.
    float rounding = 4.0 * u_unit_roundoff * moments.y;
    return chebyshev_bound(moments.x, moments.y, warped, slope * slope * depth_variance + rounding);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Receiver receiver = fetch_receiver(pixel);
    int layer = choose_layer(receiver);
    FilteredReceiver filtered = filter_receiver(pixel, receiver, layer, locate_in_map(receiver, layer));
    // Relative errors of the warped depths, as of depth: exp is right to 3 + 2 |c z| units.
    vec2 rounding = (8.0 / max(u_exponents, 1e-6) + 4.0) * exp2(-24.0) + 2.0 * u_unit_roundoff / max(u_exponents, 1e-6);

    // The mean of exp(c z) over the receiver's own plane is no smaller than exp(c mean): convex.
    float depth = filtered.depth - rounding.x;
    float warped = exp(u_exponents.x * depth);
    float lit = bound_warped(filtered.moments.xy, warped, u_exponents.x * warped, filtered.texel_variance);
#if COMPONENTS == 4
    // That of -exp(-c z) is smaller than -exp(-c mean). Its kernel being bounded, E exp(-c (z - mean)) is at most
    // exp(c^2 v / 2), v the variance that slope and kernel give: a bias of c v / 2, and never more than the reach.
    float bias = min(0.5 * u_exponents.y * filtered.variance, filtered.reach);
    depth = filtered.depth - bias - rounding.y;
    warped = -exp(-u_exponents.y * depth);
    lit = min(lit, bound_warped(filtered.moments.zw, warped, u_exponents.y * warped, filtered.texel_variance));
#endif
    visibility = combine_visibility(receiver, layer, reduce_bleeding(lit, u_bleed_reduction));
}
