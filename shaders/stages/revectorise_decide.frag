// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// First of two programs of a revectorised resolve: decides the pixels whose texel has no discontinuity, which are most,
// and leaves the others to the program that walks.
// Defines: those of revectorise_inputs.glsl; EXITING (1: texels in shadow are revectorised too).
#include "stages/revectorise_inputs.glsl"

layout(location = 0) out float visibility;

void main() {
    fetch_fragment(ivec2(gl_FragCoord.xy));
    uint code = look_at_own_texel();
    if (needs_walk(code, EXITING != 0)) discard;
    visibility = combine_with_texel(code);
}
