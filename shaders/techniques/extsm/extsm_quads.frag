// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What a texel keeps of an edge: the inverted coordinate over the quad with its guard zone, and the edge's depth.
// Blended by the maximum; the sign makes that the nearest or the farthest depth.
// Based on: [Bujnak04] 4.1, 4.2.
#include "techniques/extsm/edge_seen.glsl"
#include "techniques/extsm/extended_map.h"

layout(location = 3) uniform float u_depth_sign;
layout(location = 4) uniform float u_guard_zone;

in float coordinate;
in vec3 foot;
layout(location = 0) out float edge_value;
layout(location = 1) out float edge_depth;

void main() {
    if (!is_edge_seen(foot)) discard;
    edge_value = 1.0 - max(coordinate, u_guard_zone);
    edge_depth = u_depth_sign * foot.z;
}
