// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// A quad along each edge, wide enough that every texel whose 2 x 2 neighbourhood the edge can cross is drawn, and
// longer than the edge by as much, so that the quads of edges that meet overlap. Six vertices per edge, pulled from
// one buffer.
// Based on: [Kenzel13] 3.2.2.
#include "shared/edge_map.h"

layout(std430, binding = kEdgeListSlot) readonly buffer EdgeBlock {
    MapEdge edges[];
};
layout(location = 0) uniform float u_half_width_texels;
layout(location = 1) uniform float u_size_texels;

flat out vec3 edge_start;
flat out vec3 edge_end;

void main() {
    MapEdge edge = edges[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    bool at_end = corner == 1 || corner == 2 || corner == 4;
    float side = corner == 2 || corner == 4 || corner == 5 ? 1.0 : -1.0;

    vec2 along = edge.end.xy - edge.start.xy;
    float len = length(along);
    vec2 direction = len > 0.0 ? along / len : vec2(1, 0);
    vec4 end = at_end ? edge.end : edge.start;
    float half_width = u_half_width_texels * end.w;
    vec2 place = end.xy + (direction * (at_end ? 1.0 : -1.0) + vec2(-direction.y, direction.x) * side) * half_width;

    edge_start = edge.start.xyz;
    edge_end = edge.end.xyz;
    gl_Position = vec4(place / u_size_texels * 2.0 - 1.0, 0.5, 1.0);
}
