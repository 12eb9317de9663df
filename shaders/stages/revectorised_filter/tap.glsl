// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// One tap of the kernel by the revectorisation library.

#include "stages/revectorised_filter/inputs.glsl"
#include "lib/revectorisation_smooth_lib.glsl"

const bool kHealing = SMOOTH != 0;  // kHealed or kAsTested

// [Macedo16] Eq. 2 and 3.
float evaluate_tap(ivec2 texel) {
#if SMOOTH
    return rsmss_visibility(look_at(texel, kAllSides, kHealed), texel, kernel.place, u_walk_limit, CHANNELS);
#else
    return smsr_visibility(look_at(texel, kAllSides, kAsTested), texel, kernel.place, u_walk_limit);
#endif
}
