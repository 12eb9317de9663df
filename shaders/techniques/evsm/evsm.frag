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

float bound_warped(vec2 moments, float warped) {
    // The square and the mean's square each carry a few roundings.
    return chebyshev_bound(moments.x, moments.y, warped, 4.0 * u_unit_roundoff * moments.y);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Receiver receiver = fetch_receiver(pixel);
    int layer = choose_layer(receiver);
    FilteredReceiver filtered = filter_receiver(pixel, receiver, layer, locate_in_map(receiver, layer));
    // Relative errors of the warped depths, as of depth: exp is right to 3 + 2 |c z| units.
    vec2 rounding = (8.0 / max(u_exponents, 1e-6) + 4.0) * exp2(-24.0) + 2.0 * u_unit_roundoff / max(u_exponents, 1e-6);

    // The mean of exp(c z) over the receiver's own plane is no smaller than exp(c mean): convex.
    float lit = bound_warped(filtered.moments.xy, exp(u_exponents.x * (filtered.depth - rounding.x)));
#if COMPONENTS == 4
    // That of -exp(-c z) is smaller than -exp(-c mean). Its kernel being bounded, E exp(-c (z - mean)) is at most
    // exp(c^2 v / 2), v the variance that slope and kernel give: a bias of c v / 2, and never more than the reach. Nor
    // more than from the one warp's mean to the other's, or a receiver that the light grazes would see through casters.
    float apart = log(filtered.moments.x) / u_exponents.x + log(-filtered.moments.z) / u_exponents.y;
    float bias = min(min(0.5 * u_exponents.y * filtered.variance, filtered.largest_rise), max(apart, 0.0));
    float lit_behind = bound_warped(filtered.moments.zw, -exp(-u_exponents.y * (filtered.depth - bias - rounding.y)));
    lit = min(lit, lit_behind);
#endif
    visibility = combine_visibility(receiver, layer, reduce_bleeding(lit, u_bleed_reduction));
}
