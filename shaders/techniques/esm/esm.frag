// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exponential shadow mapping: the step of the depth test becomes exp(c (caster - receiver)), which can be averaged
// before the receiver is known.
// Defines: those of stages/moment_inputs.glsl.
// Based on: [Annen08]. Differences: docs/techniques/esm.md.
#include "stages/moment_inputs.glsl"
#include "lib/moment_lib.glsl"

layout(location = 8) uniform float u_exponent;
layout(location = 0) out float visibility;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Receiver receiver = fetch_receiver(pixel);
    int layer = choose_layer(receiver);
    FilteredReceiver filtered = filter_receiver(pixel, receiver, layer, locate_in_map(receiver, layer));
    // The map's numbers are right to a factor of 1 + a few units; exp itself to 3 + 2 |c z| of them.
    float rounding = (8.0 + 4.0 * u_exponent) * exp2(-24.0) + 2.0 * u_unit_roundoff;
    // [Annen08] Eq. 8
    float lit = min(filtered.moments.x * exp(rounding - u_exponent * filtered.depth), 1.0);
    visibility = combine_visibility(receiver, layer, lit);
}
