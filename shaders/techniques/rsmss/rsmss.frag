// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Revectorised shadows with smoothed borders, for the pixels at discontinuities (the others:
// stages/revectorise_decide.frag).
// Defines: those of revectorise_inputs.glsl; CHANNELS: kChannelsPaper or kChannelsDisjoint; THRESHOLD (1: 0 or 1, cut
// at one half).
// Based on: [Macedo16] 3.3.
#include "stages/revectorise_inputs.glsl"
#include "lib/revectorisation_smooth_lib.glsl"

layout(location = 0) out float visibility;

void main() {
    fetch_fragment(ivec2(gl_FragCoord.xy));
    uint code = look_at(fragment.texel, kAllSides, kHealed);
    float walked = rsmss_visibility(code, fragment.texel, fragment.place, u_walk_limit, CHANNELS);
#if THRESHOLD
    walked = step(0.5, walked);
#endif
    visibility = combine_visibility(fragment.receiver, fragment.layer, walked);
}
