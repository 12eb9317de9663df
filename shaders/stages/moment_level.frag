// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The next mipmap level: each texel is the mean of the area of the finer level that it covers. Sides need not be even;
// a texel then covers up to three along a side, the outer ones in part.
layout(binding = 0) uniform sampler2DArray moments_tx;
layout(location = 0) uniform int u_layer;
layout(location = 1) uniform int u_from_level;
layout(location = 2) uniform ivec2 u_size;  // of the level to be made
layout(location = 0) out vec4 stored;

void main() {
    ivec2 fine = textureSize(moments_tx, u_from_level).xy;
    vec2 scale = vec2(fine) / vec2(u_size);
    vec2 low = floor(gl_FragCoord.xy) * scale, high = low + scale;
    ivec2 first = ivec2(floor(low + 1e-3)), last = min(ivec2(ceil(high - 1e-3)), fine);
    stored = vec4(0);
    float total = 0.0;
    for (int y = first.y; y < last.y; ++y)
        for (int x = first.x; x < last.x; ++x) {
            vec2 covered = min(vec2(x, y) + 1.0, high) - max(vec2(x, y), low);
            float weight = covered.x * covered.y;
            stored += weight * texelFetch(moments_tx, ivec3(x, y, u_layer), u_from_level);
            total += weight;
        }
    stored /= total;
}
