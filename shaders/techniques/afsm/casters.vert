// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// A caster's rectangle of texels: conservative, whatever the triangle's shape.
#include "techniques/afsm/receiver_list.h"

layout(std430, binding = kListCastersSlot) readonly buffer Casters { ListCaster casters[]; };

uniform uint u_first;
uniform float u_side;

flat out vec4 edge_0, edge_1, edge_2, depth_form;
flat out ivec2 middle;
flat out uvec2 ids;
flat out uint number;

void main() {
    number = u_first + uint(gl_VertexID) / 6u;
    ivec4 rect = casters[number].rect;
    edge_0 = casters[number].edges[0];
    edge_1 = casters[number].edges[1];
    edge_2 = casters[number].edges[2];
    depth_form = casters[number].depth;
    middle = (rect.xy + rect.zw) / 2;
    ids = uvec2(casters[number].instance, casters[number].triangle);
    // Two triangles with the corners 0 1 2 and 2 1 3.
    int of_six = gl_VertexID % 6, which = of_six < 3 ? of_six : of_six == 3 ? 2 : of_six == 4 ? 1 : 3;
    ivec2 corner = ivec2((which & 1) != 0 ? rect.z : rect.x, (which & 2) != 0 ? rect.w : rect.y);
    gl_Position = vec4(vec2(corner) / u_side * 2.0 - 1.0, casters[number].top, 1.0);
}
