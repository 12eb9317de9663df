// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges over the blocks within reach, along one axis; the base's depth stays.
#include "shared/depth_range.h"

layout(binding = kDepthRangeUnit) uniform sampler2DArray depth_range_tx;
layout(binding = kDepthStepsUnit) uniform sampler2DArray depth_steps_tx;
layout(location = 0) uniform int u_layer;
layout(location = 1) uniform ivec2 u_axis;
layout(location = 2) uniform int u_radius_blocks;
layout(location = 0) out vec4 range;
layout(location = 1) out vec4 steps;

void main() {
    ivec2 own = ivec2(gl_FragCoord.xy);
    ivec2 top = textureSize(depth_range_tx, 0).xy - 1;
    range = texelFetch(depth_range_tx, ivec3(own, u_layer), 0);
    steps = texelFetch(depth_steps_tx, ivec3(own, u_layer), 0);
    for (int k = 1; k <= u_radius_blocks; ++k)
        for (int side = -1; side <= 1; side += 2) {
            ivec3 at = ivec3(clamp(own + side * k * u_axis, ivec2(0), top), u_layer);
            vec2 other = texelFetch(depth_range_tx, at, 0).xy;
            vec4 other_steps = texelFetch(depth_steps_tx, at, 0);
            range.xy = vec2(min(range.x, other.x), max(range.y, other.y));
            steps.xz = min(steps.xz, other_steps.xz);
            steps.yw = max(steps.yw, other_steps.yw);
        }
}
