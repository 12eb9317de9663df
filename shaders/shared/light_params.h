// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One light position as the resolve passes need it: a uniform block in std140 layout, compiled by C++ and by GLSL.

#include "shared/view_choice.h"

#ifdef __cplusplus
namespace shadow_layers {
using glm::mat4;
using glm::uvec4;
using glm::vec4;
#endif

const int kLightParamsSlot = 0;  // uniform buffer binding
const int kPositionUnit = 0;     // texture units of the resolve passes
const int kNormalUnit = 1;
const int kDepthMapUnit = 2;
const int kEdgeMapUnit = 3;

struct LightParams {
    mat4 lc_from_rel[kMaxViews];  // by map layer
    vec4 axes_rel[3];             // the sample's x, y and z axis: view choice, cone; w: dot(axis, position), in double
    vec4 place_rel;               // w = 1: the position; w = 0: unit vector towards the sun
    vec4 cone;               // cosine (-2: all directions), sine of half the cone's angle; 1 / its width along x, y
    ViewChoice view_choice;  // of a map layer
    vec4 map;                // texels per side with border, its inverse, border in texels, unused
    uvec4 receivers;         // light's receiver set (low, high word); z = 1: casts shadows
};

#ifdef __cplusplus
static_assert(sizeof(LightParams) == 64 * 6 + 16 * 10, "std140 layout");
}  // namespace shadow_layers
#endif
