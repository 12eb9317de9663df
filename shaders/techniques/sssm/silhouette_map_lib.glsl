// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A cell of the silhouette map: the square between four texel centres of the depth map. It holds one point; spokes from
// there to the points of the four neighbouring cells cut it into four parts, one to each corner's depth test.
// Based on: [Sen03] as described in [Kenzel13] 2.2; the rule for parts of any shape is derived.
// Everything is in texels, about the cell's lower left corner.

float cross_2d(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

// Is `h` between the directions `from` and `to`, turning to the left? Also for turns of more than half a circle.
bool is_in_wedge(vec2 from, vec2 to, vec2 h) {
    bool after_from = cross_2d(from, h) >= 0.0, before_to = cross_2d(h, to) >= 0.0;
    return cross_2d(from, to) >= 0.0 ? after_from && before_to : after_from || before_to;
}

// Which corner's part holds `at`? 0 (0,0), 1 (1,0), 2 (0,1), 3 (1,1). `own` and the neighbours' points, all about this
// cell's corner.
int find_quadrant(vec2 at, vec2 own, vec2 left, vec2 right, vec2 below, vec2 above) {
    vec2 h = at - own;
    if (is_in_wedge(right - own, above - own, h)) return 3;
    if (is_in_wedge(above - own, left - own, h)) return 2;
    if (is_in_wedge(left - own, below - own, h)) return 0;
    return 1;
}

// The part of the segment inside the square [low, low + 1]^2, as the range of its parameter; empty if x > y.
vec2 cut_to_cell(vec2 start, vec2 end, vec2 low) {
    vec2 along = end - start;
    vec2 range = vec2(0, 1);
    for (int axis = 0; axis < 2; ++axis) {
        if (along[axis] == 0.0) {
            if (start[axis] < low[axis] || start[axis] > low[axis] + 1.0) return vec2(1, 0);
            continue;
        }
        float first = (low[axis] - start[axis]) / along[axis], last = (low[axis] + 1.0 - start[axis]) / along[axis];
        range = vec2(max(range.x, min(first, last)), min(range.y, max(first, last)));
    }
    return range;
}
