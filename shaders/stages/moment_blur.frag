// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Mean along the columns of one layer's rows-averaged moments.
#include "shared/moment_limits.h"

layout(binding = 0) uniform sampler2D moments_tx;
layout(location = 0) uniform int u_radius;
layout(location = 1) uniform float u_weights[kMostBlurTexels + 1];
layout(location = 0) out vec4 stored;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    int last = textureSize(moments_tx, 0).y - 1;
    stored = vec4(0);
    for (int offset = -u_radius; offset <= u_radius; ++offset)
        stored += u_weights[abs(offset)] * texelFetch(moments_tx, ivec2(at.x, clamp(at.y + offset, 0, last)), 0);
}
