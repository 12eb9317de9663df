// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// From the four depth tests and the four edge texels round a sample to the signed distance of the shadow's border.
// Distances in texels, positive = lit. Corners are numbered (0,0) (1,0) (0,1) (1,1); `at` is the sample in the unit
// square.
// Based on: [Kenzel13] 3.1.1 and 4.2.2.
// Differences: the thesis interpolates signed distances bilinearly and lets their sign decide. Here the depth tests
// give the signs and the map gives only distances, or one line that agrees with all four tests.

struct EdgeTexel {
    vec2 normal;     // unit, of the line through the texel's nearest edge, towards its lit side
    float distance;  // signed along normal, from the texel's centre
    bool relevant;   // false: no edge here, or one that lies behind the receiver
};

const vec2 kCorners[4] = vec2[4](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(1, 1));

vec4 bilinear_weights(vec2 at) {
    return vec4((1.0 - at.x) * (1.0 - at.y), at.x * (1.0 - at.y), (1.0 - at.x) * at.y, at.x * at.y);
}

// What the footprint's texels say, one after the other. Two answers are kept:
//   forced  - tests give the sign, texels the distance: sum of w_k (s_k ? m_k : -m_k). `missing` is the distance
//             of a texel without an edge; 1/2 puts the border midway between disagreeing tests;
//   by line - a line is believed if it has all lit corners on its lit side and all others on the other. Of several,
//             that of the nearest texel counts. A line that separates them the other way round is another caster's.
struct BorderEstimate {
    float forced;       // signed distance
    float by_line;      // signed distance, if line_weight > 0
    float line_weight;  // 0: no line agrees with the tests
};

const BorderEstimate kNoEstimate = BorderEstimate(0.0, 0.0, 0.0);

// The raster places a vertex to 1/256 of a texel, so a centre that close to a line may lie on either side of it.
const float kLineTolerance = 1.0 / 64.0;

// `corner` and `weight` belong to the texel; `signs` are +1 for lit and -1 for shadowed corners.
void add_texel(inout BorderEstimate estimate, EdgeTexel texel, vec2 corner, float weight, float own_sign, vec4 signs,
               vec2 at, float missing) {
    estimate.forced += weight * own_sign * (texel.relevant ? abs(texel.distance) : missing);

    vec2 normal = texel.normal;
    float at_origin = texel.distance - dot(normal, corner);
    vec4 agreement = (at_origin + vec4(0.0, normal.x, normal.y, normal.x + normal.y)) * signs;
    bool agrees = all(greaterThan(agreement, vec4(-kLineTolerance)));
    if (texel.relevant && agrees && weight > estimate.line_weight) {
        estimate.line_weight = weight;
        estimate.by_line = at_origin + dot(normal, at);
    }
}

float border_distance(BorderEstimate estimate) {
    return estimate.line_weight > 0.0 ? estimate.by_line : estimate.forced;
}

// Light that passes a straight border at `signed_distance` from a round source of the given width: the part of the
// disc on the lit side. The kernel of [Kenzel13] figure 6.1.
float disc_kernel(float signed_distance, float width) {
    float x = clamp(2.0 * signed_distance / width, -1.0, 1.0);
    return 0.5 + (x * sqrt(1.0 - x * x) + asin(x)) * (1.0 / 3.14159265358979);
}
