// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Two triangles per listed rectangle of the picture.
#include "techniques/edtsm/penumbra_params.h"

layout(std430, binding = kTileListSlot) readonly buffer TileBlock {
    uvec2 rectangles[];  // x: first column, end column << 16; y: first row, end row << 16
};
layout(location = 0) uniform vec2 u_picture_size;

void main() {
    uvec2 packed_rectangle = rectangles[gl_VertexID / 6];
    uvec2 low = packed_rectangle & 0xFFFFu, high = packed_rectangle >> 16;
    int corner = gl_VertexID % 6;
    corner = corner < 3 ? corner : 6 - corner;  // 0 1 2, 3 2 1
    vec2 at = vec2((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y);
    gl_Position = vec4(at / u_picture_size * 2.0 - 1.0, 0.5, 1.0);
}
