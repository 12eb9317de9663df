// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels without a site in reach keep their hard visibility; the others are left to edtsm_penumbra.frag.
#include "lib/nearest_site_lib.glsl"
#include "shared/penumbra_params.h"

layout(binding = kHardVisibilityUnit) uniform sampler2D visibility_tx;
layout(binding = kNearestUnit) uniform usampler2D nearest_tx;
layout(location = 0) out vec4 soft;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (is_site(texelFetch(nearest_tx, pixel, 0).x)) discard;
    // No filter radius, and no tap for others: see edtsm_penumbra.frag.
    soft = vec4(texelFetch(visibility_tx, pixel, 0).x, 0.0, 0.0, 0.0);
}
