// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// First pass: the discontinuities of each pixel's texel, as the camera sees them. [Bondarev14], [Macedo16] 3.1: d_c.
// Defines: those of revectorise_inputs.glsl.
#include "stages/revectorise_inputs.glsl"
#include "techniques/smsr2/smsr2_record.glsl"

layout(location = 0) out uint record;

void main() {
    fetch_fragment(ivec2(gl_FragCoord.xy));
    bool map_decides = fragment.receiver.fixed_visibility == kMapDecides && fragment.layer >= 0;
    uint fixed_code = combine_with_texel(0u) > 0.5 ? kLitTexel : 0u;
    record = map_decides ? look_at_own_texel() | place_bits(fragment.texel, fragment.layer) : fixed_code;
}
