// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sites of a shadow's border in the picture, and the light as a penumbra needs it. Compiled by C++ and by GLSL.

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace shadow_layers {
using glm::vec4;
using uint = std::uint32_t;
#endif

const int kHardVisibilityUnit = 3;  // texture units
const int kBorderUnit = 4;
const int kNearestUnit = 5;
const int kSoftUnit = 6;
const int kPenumbraParamsSlot = 2;  // uniform buffer binding
const int kBorderStatsSlot = 3;     // shader storage bindings
const int kTileListSlot = 4;

// What decides how wide a penumbra is: std140.
struct PenumbraParams {
    vec4 width;          // penumbra in scene units, in pixels; mean filter's size as a part of the penumbra; unused
    vec4 light_u;        // half axis or half side of the light: a vector of an area light; x = radius otherwise (sun:
    vec4 light_v;        // tangent of half its angle). light_u.w: shape (light_cut_lib.glsl), light_v.w = 1: area
    vec4 map_depths[6];  // by map layer: near and far depth of the view; z = 1: perspective
};

// Filled while sites are found. A site's reach is how far its penumbra goes on the screen, mean filter included.
struct BorderStats {
    uint site_count;
    uint largest_radius_bits;    // of a float above 0, in pixels: as integers they have the same order
    uint largest_penumbra_bits;  // likewise: penumbra's width without filter
    uint unused;
};

#ifdef __cplusplus
static_assert(sizeof(PenumbraParams) == 9 * 16, "std140 layout");
static_assert(sizeof(BorderStats) == 16, "std430 layout");
}  // namespace shadow_layers
#endif
