// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a pixel covers of the surface that it sees, and whether two pixels see one surface. Thresholds come from the
// pixel's own size at its depth, so that they hold at any scale.

#include "techniques/edtsm/pixel_camera.h"

struct Footprint {
    float depth_vs;      // along the view axis
    float side;          // the larger side of the pixel at that depth, across the view axis
    vec3 dx;             // how the point on the receiver's plane moves to the next pixel
    vec3 dy;
    vec2 depth_step;     // of depth_vs along dx and dy
};

// A plane seen edge-on runs away to infinity; its slope is cut where it passes this many pixel sides of depth per
// pixel.
const float kSteepestPlane = 1e4;

Footprint compute_footprint(PixelCamera camera, vec3 position_rel, vec3 normal) {
    Footprint footprint;
    bool is_perspective = camera.forward.w > 0.5;
    float depth_vs = dot(camera.forward.xyz, position_rel);
    float ray_scale = is_perspective ? max(depth_vs, 1e-30) : 1.0;
    vec3 direction = is_perspective ? position_rel / ray_scale : camera.forward.xyz;
    // The step to the next ray at the same view depth.
    vec3 across_x = camera.origin_dx.xyz + ray_scale * camera.direction_dx.xyz;
    vec3 across_y = camera.origin_dy.xyz + ray_scale * camera.direction_dy.xyz;
    footprint.depth_vs = depth_vs;
    footprint.side = max(length(across_x), length(across_y));
    // Then along the ray, back onto the plane: n . (across + step * direction) = 0.
    float slope = dot(normal, direction);
    float gentle = max(abs(slope), length(direction) / kSteepestPlane);
    vec2 step = vec2(dot(normal, across_x), dot(normal, across_y)) * (slope < 0.0 ? 1.0 : -1.0) / gentle;
    footprint.dx = across_x + step.x * direction;
    footprint.dy = across_y + step.y * direction;
    footprint.depth_step = step;
    return footprint;
}

// Two visible points lie on one surface if each lies on the same side of the other's plane (a fold: the planes meet
// between them) or if neither is farther off the other's plane than a pixel, plus what facets of a smooth surface may
// tilt. At a step in depth the nearer one lies before the other's plane, and the other one behind its own.
bool is_one_surface(vec3 position_a, vec3 normal_a, vec3 position_b, vec3 normal_b, float pixel_side) {
    const float facet_tilt = 0.1;  // about 6 degrees
    vec3 offset = position_b - position_a;
    float b_above_a = dot(normal_a, offset);
    float a_above_b = -dot(normal_b, offset);
    float slack = pixel_side + facet_tilt * length(offset);
    return b_above_a * a_above_b >= 0.0 || max(abs(b_above_a), abs(a_above_b)) <= slack;
}
