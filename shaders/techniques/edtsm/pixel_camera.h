// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The camera as stages that work on the picture need it: how the rays of neighbouring pixels lie to each other. A
// uniform block in std140 layout, compiled by C++ and by GLSL.

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace shadow_layers {
using glm::vec4;
#endif

const int kPixelCameraSlot = 1;  // uniform buffer binding

// A ray of pixel (x, y) starts at an origin and goes in a direction that is 1 long along the view axis; both are linear
// in x and y. All vectors have world axes.
struct PixelCamera {
    vec4 forward;    // unit view axis; w = 1: perspective, 0: orthographic
    vec4 origin_dx;  // how the origin moves from a pixel to the next; 0 with perspective
    vec4 origin_dy;
    vec4 direction_dx;  // likewise the direction; 0 without perspective
    vec4 direction_dy;
};

#ifdef __cplusplus
static_assert(sizeof(PixelCamera) == 5 * 16, "std140 layout");
}  // namespace shadow_layers
#endif
