// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Where the hard visibility changes at all, whatever the reason: edtsm_sites.frag looks closer there. Two gathers hold
// the pixel and its four neighbours.
#include "techniques/edtsm/penumbra_params.h"

layout(binding = kHardVisibilityUnit) uniform sampler2D visibility_tx;
layout(location = 0) uniform vec2 u_pixel;  // 1 / size of the picture
layout(location = 0) out uint candidate;

void main() {
    vec2 corner = (gl_FragCoord.xy - 0.5) * u_pixel;
    vec4 low = textureGather(visibility_tx, corner), high = textureGather(visibility_tx, corner + u_pixel);
    // Order of a gather: (0, 1), (1, 1), (1, 0), (0, 0). low: left, own, below; high: above, right, own.
    vec4 around = vec4(low.x, low.z, high.x, high.z);
    bvec4 lit = greaterThanEqual(around, vec4(0.5));
    candidate = low.y >= 0.5 ? uint(!all(lit)) : uint(any(lit));
}
