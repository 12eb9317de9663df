// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Mean over a square of the picture; the overscan holds what lies past the region's rim.
layout(binding = 0) uniform sampler2D picture_tx;
layout(location = 0) uniform int u_radius;
layout(location = 0) out float value;

void main() {
    ivec2 last = textureSize(picture_tx, 0) - 1;
    float sum = 0.0;
    for (int y = -u_radius; y <= u_radius; ++y)
        for (int x = -u_radius; x <= u_radius; ++x)
            sum += texelFetch(picture_tx, clamp(ivec2(gl_FragCoord.xy) + ivec2(x, y), ivec2(0), last), 0).x;
    float side = float(2 * u_radius + 1);
    value = sum / (side * side);
}
