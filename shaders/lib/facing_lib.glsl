// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What is decided without a map. The same rule stands in native/lights/facing.h, for the CPU.

const float kMapDecides = -1.0;

// Is the direction to the light, given in the light's axes, within the cone? `cone`: cosine (below -1: all directions)
// and sine of half its angle; what makes it round along x and y. By the component across the axis, because the cosine of a narrow cone is 1 in float.
bool is_in_cone(vec3 to_light_axes, vec4 cone) {
    return cone.x <= -1.0 || length(to_light_axes.xy * cone.zw) * cone.x <= to_light_axes.z * cone.y;
}

// Visibility, or kMapDecides. `to_light` need not be of unit length.
float visibility_without_map(bool covered, bool linked, bool in_cone, bool casts_shadow, vec3 normal, vec3 to_light) {
    bool faces_light = dot(normal, to_light) > 0.0;
    if (!covered || !linked || !in_cone) return 1.0;
    if (!faces_light) return 0.0;
    return casts_shadow ? kMapDecides : 1.0;
}

bool group_is_in(uint group, uvec2 set) {
    uint word = group < 32u ? set.x : set.y;
    return ((word >> (group & 31u)) & 1u) != 0u;
}
