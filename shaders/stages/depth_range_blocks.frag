// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// One block of the depth map: range of depths, range of steps from each texel to the next, also into the next block.
// Beyond the map's rim the last texel goes on.
#include "shared/depth_range.h"
#include "shared/light_params.h"

layout(binding = kDepthMapUnit) uniform sampler2DArray depth_map_tx;
layout(location = 0) uniform int u_layer;
layout(location = 0) out vec4 range;
layout(location = 1) out vec4 steps;

vec2 g_scale;

// Texels (0, 1), (1, 1), (1, 0), (0, 0) from a corner.
vec4 gather(vec2 corner) { return textureGather(depth_map_tx, vec3((corner + 1.0) * g_scale, u_layer)); }

float least(vec4 v) { return min(min(v.x, v.y), min(v.z, v.w)); }
float greatest(vec4 v) { return max(max(v.x, v.y), max(v.z, v.w)); }

void main() {
    vec2 base = floor(gl_FragCoord.xy) * float(kRangeBlockTexels);
    g_scale = 1.0 / vec2(textureSize(depth_map_tx, 0).xy);
    vec4 low = vec4(2), high = vec4(-2);                          // depths
    vec4 low_x = low, high_x = high, low_y = low, high_y = high;  // steps
    vec4 below[kRangeBlockTexels / 2];
    for (int i = 0; i < kRangeBlockTexels / 2; ++i) below[i] = gather(base + vec2(2 * i, 0));
    range.z = below[0].w;
    for (int j = 0; j < kRangeBlockTexels / 2; ++j) {
        vec4 right = gather(base + vec2(kRangeBlockTexels, 2 * j));
        for (int i = kRangeBlockTexels / 2 - 1; i >= 0; --i) {
            vec4 own = below[i], above = gather(base + vec2(2 * i, 2 * j + 2));
            vec4 x = vec4(own.yz - own.xw, right.xw - own.yz), y = vec4(own.xy - own.wz, above.wz - own.xy);
            low = min(low, own), high = max(high, own);
            low_x = min(low_x, x), high_x = max(high_x, x);
            low_y = min(low_y, y), high_y = max(high_y, y);
            right = own;
            below[i] = above;
        }
    }
    range = vec4(least(low), greatest(high), range.z, 0);
    steps = vec4(least(low_x), greatest(high_x), least(low_y), greatest(high_y));
}
