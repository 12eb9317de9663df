// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// A quad along each silhouette edge, from one diagonal of a texel inside the caster to two outside.
// Based on: [Bujnak04] 4.1, figure 4. Difference: in the map, from steps that were worked in double.
#include "techniques/extsm/extended_map.h"

layout(std430, binding = kExtendedQuadSlot) readonly buffer QuadBlock {
    ExtendedQuad quads[];
};
layout(location = 1) uniform float u_size_texels;

out float coordinate;
out vec3 foot;

void main() {
    ExtendedQuad quad = quads[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    bool at_end = corner == 1 || corner == 2 || corner == 4;
    bool outside = corner == 2 || corner == 4 || corner == 5;

    foot = at_end ? quad.end.xyz : quad.start.xyz;
    coordinate = outside ? 1.0 : 0.0;
    vec2 outward = at_end ? quad.outward.zw : quad.outward.xy;
    vec2 place = foot.xy + outward * ((coordinate - kEdgeCoordinate) * kQuadWidthTexels);
    gl_Position = vec4(place / u_size_texels * 2.0 - 1.0, 0.5, 1.0);
}
