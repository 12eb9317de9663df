// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Depths that can be averaged. A map holds depth_rz = near (far - w) / ((far - near) w), or (far - w) / (far - near)
// in a parallel view, with w along the view's axis. Solved for w and scaled to -1 at near and kFarDepth at far,
//
//   depth_lin = (1 + kFarDepth) (1 - depth_rz) / (1 + s depth_rz) - 1,  s = far / near - 1, or 0 in a parallel view.
//
// Powers of numbers round zero lose less to rounding than those of numbers between 0 and 1. The result is convex and
// falling in depth_rz, which itself is planar over a plane.
const float kFarDepth = 0.8;

float linear_depth(float depth_rz, float relative_range) {
    return (1.0 + kFarDepth) * (1.0 - depth_rz) / (1.0 + relative_range * depth_rz) - 1.0;
}

// -d depth_lin / d depth_rz, positive.
float linear_depth_slope(float depth_rz, float relative_range) {
    float scale = 1.0 + relative_range * depth_rz;
    return (1.0 + kFarDepth) * (1.0 + relative_range) / (scale * scale);
}

// A texel that is empty, or whose surface lies beyond the far plane, blocks nothing. It lies at 1, some way behind the
// plane: a receiver that passes the far plane within a kernel would otherwise find its own average too near.
float texel_depth(float depth_rz, float relative_range) {
    return depth_rz > 0.0 ? linear_depth(depth_rz, relative_range) : 1.0;
}
