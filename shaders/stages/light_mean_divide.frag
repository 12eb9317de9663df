// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The weighted mean. Lit by all samples gives 1 to the bit: both sums are then the same.
layout(binding = 0) uniform sampler2D sums_tx;
layout(location = 0) out float visibility;

void main() {
    vec2 sums = texelFetch(sums_tx, ivec2(gl_FragCoord.xy), 0).xy;
    visibility = min(sums.x / sums.y, 1.0);
}
