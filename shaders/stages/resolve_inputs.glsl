// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What every resolve pass starts from: the pixel's receiver, and its place in the light's map.

#include "shared/light_params.h"
#include "lib/facing_lib.glsl"
#include "lib/projection_lib.glsl"

layout(std140, binding = kLightParamsSlot) uniform LightBlock {
    LightParams light;
};
layout(binding = kPositionUnit) uniform sampler2D position_tx;  // xyz: position_rel, w: coverage
layout(binding = kNormalUnit) uniform sampler2D normal_tx;      // xyz: normal, w: receiver group

struct Receiver {
    vec3 position_rel;
    vec3 normal;
    vec3 to_light;           // not of unit length
    vec3 to_light_axes;      // from the receiver to a light with a place, in the light's axes
    float fixed_visibility;  // or kMapDecides
};

Receiver fetch_receiver(ivec2 pixel) {
    vec4 position = texelFetch(position_tx, pixel, 0);
    vec4 normal = texelFetch(normal_tx, pixel, 0);
    Receiver receiver;
    receiver.position_rel = position.xyz;
    receiver.normal = normal.xyz;
    receiver.to_light = light.place_rel.xyz - light.place_rel.w * position.xyz;
    for (int axis = 0; axis < 3; ++axis)
        receiver.to_light_axes[axis] = light.axes_rel[axis].w - dot(light.axes_rel[axis].xyz, position.xyz);
    receiver.fixed_visibility =
        visibility_without_map(position.w > 0.5, group_is_in(uint(normal.w), light.receivers.xy),
                               is_in_cone(receiver.to_light_axes, light.cone), light.receivers.z != 0u, normal.xyz,
                               receiver.to_light);
    return receiver;
}

// Map layer that holds the receiver, or kNoView.
int choose_layer(Receiver receiver) {
    return choose_view(light.view_choice, -receiver.to_light_axes);
}

MapPoint locate_in_map(Receiver receiver, int layer) {
    return project_receiver(light.lc_from_rel[max(layer, 0)], receiver.position_rel, receiver.normal, light.map.x);
}

// The map's answer where the map decides. A receiver that no view covers has no caster before it.
float combine_visibility(Receiver receiver, int layer, float from_map) {
    if (receiver.fixed_visibility != kMapDecides) return receiver.fixed_visibility;
    return layer < 0 ? 1.0 : from_map;
}
