// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the passes of edtsm share: the picture's camera, the penumbra's parameters, and how wide a penumbra is.
// Defines: FROM_LIGHT (1: the penumbra's width comes from the light's size), SCREEN_METRIC (1: pixels, 0: scene units).

#include "stages/resolve_inputs.glsl"
#include "techniques/edtsm/pixel_footprint_lib.glsl"
#include "techniques/edtsm/penumbra_params.h"

layout(std140, binding = kPixelCameraSlot) uniform CameraBlock {
    PixelCamera camera;
};
layout(std140, binding = kPenumbraParamsSlot) uniform PenumbraBlock {
    PenumbraParams penumbra;
};

// A penumbra from the light is wider on a slope than across the light's rays; more than this is not looked for.
const float kLargestSlant = 5.0;

float slant_of(Receiver receiver) {
#if FROM_LIGHT
    float slope = dot(receiver.normal, receiver.to_light) / max(length(receiver.to_light), 1e-30);
    return 1.0 / max(slope, 1.0 / kLargestSlant);
#else
    return 1.0;
#endif
}

// Half the light's size as seen from a point: its radius, or the half diagonal of an area light.
float half_light_size(float distance_to_light) {
    if (penumbra.light_v.w > 0.5) return length(penumbra.light_u.xyz) + length(penumbra.light_v.xyz);
    float radius = penumbra.light_u.x;
    if (light.place_rel.w < 0.5) return radius;
    // The rays that touch a sphere pass its centre's plane a little outside of it.
    float share = min(radius / max(distance_to_light, 1e-30), 0.99);
    return radius / sqrt(1.0 - share * share);
}

// Width of the penumbra in scene units, across the light's rays, where the blocker lies `gap` before the receiver.
// Similar triangles: P = size * gap / (distance to the light - gap); of the sun: angle * gap.
float penumbra_width(float gap, float distance_to_light) {
#if FROM_LIGHT
    float size = 2.0 * half_light_size(distance_to_light);
    return light.place_rel.w < 0.5 ? size * gap : size * gap / max(distance_to_light - gap, 1e-6 * distance_to_light);
#else
    return penumbra.width.x;
#endif
}
