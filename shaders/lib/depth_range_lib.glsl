// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Decides all depth tests of a window of texels at once, or says that it cannot. Never wrong: a window that is decided
// has that answer at each of its texels, to the last bit of each test.
//
// Two bounds. Where casters are well before the window's receiver, or all lies well behind it, the range of depths is
// enough. On a lit slope it is not: the map is the receiver itself, and its depths overlap those that the taps are
// compared with. There the least and greatest steps from texel to texel bound the map by two planes through one texel
// of it, and the receiver's own plane is compared with those.

#include "lib/projection_lib.glsl"

struct DepthWindow {
    float low, high;   // least and greatest depth_rz
    float base_depth;  // depth_rz at the texel `base`, which is in the window
    vec4 steps;        // along x: least, greatest; along y: least, greatest
    vec2 base;         // texel
    vec2 first, last;  // lowest and highest texel of the taps, inclusive
    bool steps_hold;   // all taps and the base lie in the map, so that steps lead to them
};

const float kWindowMixed = -1.0;  // else 0 or 1, the answer of all tests

// Least value of plane-following reference depths over the window, and greatest. `reference_depth` grows with the dot
// product of gradient and offset, so that its bounds are at corners of the window. The two compilations of that product
// may round apart by a unit or two.
vec2 bound_reference(MapPoint point, vec2 nearest_offset, vec2 farthest_offset) {
    vec2 a = point.gradient * nearest_offset, b = point.gradient * farthest_offset;
    vec2 least = min(a, b), greatest = max(a, b);
    float rounding = (1.0 / 4194304.0) * dot(max(abs(a), abs(b)), vec2(1));  // 2^-22
    vec2 along = vec2(least.x + least.y - rounding, greatest.x + greatest.y + rounding);
    return max(point.depth_rz + max(along, 0.0) + point.rounding, 0.0);
}

// Greatest excess of the map over the receiver's plane, over the window. Following the steps from the base to a texel
// n columns and m rows away gives at most base_depth + n s_x + m s_y with s the greatest step where n is positive, the
// least where it is negative.
float bound_excess(MapPoint point, DepthWindow window) {
    vec2 from_base = window.base + 0.5 - point.texel;
    vec2 up = max(window.last - window.base, 0.0), down = max(window.base - window.first, 0.0);
    vec2 rise = max(window.steps.yw - point.gradient, 0.0), fall = max(point.gradient - window.steps.xz, 0.0);
    float excess = window.base_depth - (point.depth_rz + point.rounding) - dot(point.gradient, from_base) +
                   dot(rise, up) + dot(fall, down);
    // Roundings of the steps, of this sum and of the tests' own sums: some eight units of the largest terms.
    vec2 reach = up + down + 1.0;
    vec2 slopes = abs(point.gradient) + max(abs(window.steps.xz), abs(window.steps.yw));
    return excess + (1.0 / 2097152.0) * (abs(point.depth_rz) + window.base_depth + dot(slopes, reach));
}

float decide_window(MapPoint point, DepthWindow window) {
    vec2 reference = bound_reference(point, window.first + 0.5 - point.texel, window.last + 0.5 - point.texel);
    if (reference.y < window.low) return 0.0;
    bool lit = reference.x >= window.high || (window.steps_hold && bound_excess(point, window) <= 0.0);
    return lit ? 1.0 : kWindowMixed;
}
