// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Which part of a light with a shape is left of a straight cut: the visibility behind a straight blocker edge, in
// closed form. Areas are taken in the light's own plane; how brightly its points are seen does not weigh in.

const int kCutDisc = 0;    // an ellipse with the given half axes
const int kCutSquare = 1;  // a rectangle with the given half sides

// Part of a unit disc where x <= t.
float fraction_of_disc(float t) {
    t = clamp(t, -1.0, 1.0);
    return 0.5 + (t * sqrt(1.0 - t * t) + asin(t)) / 3.14159265358979;
}

// Part of the square [-1, 1]^2 where dot(slope, p) <= at. Along the slope the square's width is a trapezoid; this is
// its integral. |slope.x| + |slope.y| > 0.
float fraction_of_square(vec2 slope, float at) {
    slope = abs(slope) / (abs(slope.x) + abs(slope.y));
    at = clamp(at, -1.0, 1.0);
    float low = min(slope.x, slope.y), flat_end = 1.0 - 2.0 * low;
    // By symmetry from the middle: the flat part, then the flank that falls to 0 at the corner.
    float inside = min(abs(at), flat_end), outside = max(abs(at) - flat_end, 0.0);
    float height = 1.0 / max(2.0 - 2.0 * low, 1e-30);  // of the flat part: its area and the flanks' make 1
    float area = inside * height;
    if (low > 0.0) area += outside * height * (1.0 - outside / (4.0 * low));
    return 0.5 + sign(at) * min(area, 0.5);
}

// Part of the light beside the plane through `from` whose normal is `normal`, on the light centre's side: half of it or
// more. `to_centre`: from the same point to the light's centre; `half_u`, `half_v`: half axes or sides.
float fraction_beside_plane(int shape, vec3 normal, vec3 to_centre, vec3 half_u, vec3 half_v) {
    float centre = abs(dot(normal, to_centre));
    vec2 slope = vec2(dot(normal, half_u), dot(normal, half_v));
    float half_extent = shape == kCutSquare ? abs(slope.x) + abs(slope.y) : length(slope);
    // No slope: the plane does not cut the light's plane near it (or there is no plane), and all of it is on one side.
    if (!(centre < half_extent)) return centre > 0.0 ? 1.0 : 0.5;
    return shape == kCutSquare ? fraction_of_square(slope, centre / half_extent)
                               : fraction_of_disc(centre / half_extent);
}
