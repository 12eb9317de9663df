// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// A picture times a weight, to be added to the target.
layout(binding = 0) uniform sampler2D picture_tx;
layout(location = 0) uniform float u_weight;
layout(location = 0) out float value;

void main() { value = texelFetch(picture_tx, ivec2(gl_FragCoord.xy), 0).x * u_weight; }
