// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Second pass, first program: pixels without a discontinuity.
// Defines: EXITING (1: texels in shadow are revectorised too).
#include "lib/discontinuity_code_lib.glsl"
#include "techniques/smsr2/smsr2_record.glsl"

layout(binding = kDiscontinuityUnit) uniform usampler2D discontinuity_tx;
layout(location = 0) out float visibility;

void main() {
    uint record = texelFetch(discontinuity_tx, ivec2(gl_FragCoord.xy), 0).x;
    bool lit = has_any(record, kLitTexel);
    if (has_any(record, kAllSides) && (lit || EXITING != 0)) discard;
    visibility = lit ? 1.0 : 0.0;
}
