// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the depth range map knows of a window of texels. Include after "stages/resolve_inputs.glsl".

#include "lib/depth_range_lib.glsl"
#include "shared/depth_range.h"

layout(binding = kDepthRangeUnit) uniform sampler2DArray depth_range_tx;
layout(binding = kDepthStepsUnit) uniform sampler2DArray depth_steps_tx;

// 0 or 1 if all tests of the texels `first` to `last` (inclusive) agree for sure, else kWindowMixed. They lie within
// `radius` texels of the receiver's own, as the map was made; else nothing is decided.
float decide_taps(MapPoint point, int layer, vec2 first, vec2 last, float radius) {
    vec2 own = floor(point.texel);
    if (any(lessThan(first, own - radius)) || any(greaterThan(last, own + radius))) return kWindowMixed;
    vec2 top = vec2(light.map.x - 1.0);
    ivec2 block = ivec2(clamp(own, vec2(0), top)) / kRangeBlockTexels;
    vec4 range = texelFetch(depth_range_tx, ivec3(block, max(layer, 0)), 0);
    DepthWindow window;
    window.low = range.x;
    window.high = range.y;
    window.base_depth = range.z;
    window.steps = texelFetch(depth_steps_tx, ivec3(block, max(layer, 0)), 0);
    window.base = vec2(block * kRangeBlockTexels);
    window.first = first;
    window.last = last;
    window.steps_hold = all(greaterThanEqual(first, vec2(0))) && all(lessThanEqual(last, top));
    return decide_window(point, window);
}
