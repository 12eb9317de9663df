// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Revectorised hard shadows, for the pixels at discontinuities (the others: stages/revectorise_decide.frag).
// Defines: those of revectorise_inputs.glsl; VISIBILITY_OF: a function of revectorisation_lib.glsl.
// Based on: [Macedo16] 3.2.
#include "stages/revectorise_inputs.glsl"

layout(location = 0) out float visibility;

void main() {
    fetch_fragment(ivec2(gl_FragCoord.xy));
    uint code = look_at(fragment.texel, kAllSides, kAsTested);
    float walked = VISIBILITY_OF(code, fragment.texel, fragment.place, u_walk_limit);
    visibility = combine_visibility(fragment.receiver, fragment.layer, walked);
}
