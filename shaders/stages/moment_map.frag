// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Depths to what a moment map stores, averaged along the rows. Depths are read once for both: they are smaller than
// what they become.
// Defines: ENCODE (a function of lib/moment_lib.glsl).
#include "lib/linear_depth_lib.glsl"
#include "lib/moment_lib.glsl"
#include "shared/light_params.h"
#include "shared/moment_limits.h"

layout(binding = kDepthMapUnit) uniform sampler2DArray depth_map_tx;
layout(location = 0) uniform int u_layer;
layout(location = 1) uniform float u_relative_range;
layout(location = 2) uniform vec2 u_exponents;
layout(location = 3) uniform int u_radius;
layout(location = 4) uniform float u_weights[kMostBlurTexels + 1];
layout(location = 0) out vec4 stored;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    int last = textureSize(depth_map_tx, 0).x - 1;
    stored = vec4(0);
    for (int offset = -u_radius; offset <= u_radius; ++offset) {
        int x = clamp(at.x + offset, 0, last);
        float depth_rz = texelFetch(depth_map_tx, ivec3(x, at.y, u_layer), 0).x;
        stored += u_weights[abs(offset)] * ENCODE(texel_depth(depth_rz, u_relative_range), u_exponents);
    }
}
