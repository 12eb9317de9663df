// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The point that a cell of the silhouette map keeps of an edge: an end that lies in the cell, so that corners stay
// sharp, else the middle of the edge's part in the cell. Edges come in cell coordinates, half a texel off the map's.
// Drawn with stages/edge_quads.vert.
// Based on: [Sen03].
#include "techniques/sssm/silhouette_map_lib.glsl"
#include "shared/light_params.h"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(location = 1) uniform float u_size_texels;
layout(location = 2) uniform int u_layer;

flat in vec3 edge_start;
flat in vec3 edge_end;
layout(location = 0) out vec2 point;

// Rounding of an edge's depth against the map's: some units in the last place of numbers up to 1.
const float kDepthRounding = 1.0 / 1048576.0;

void main() {
    vec2 low = floor(gl_FragCoord.xy);
    vec2 range = cut_to_cell(edge_start.xy, edge_end.xy, low);
    if (range.x > range.y) discard;
    float where = range.x == 0.0 ? 0.0 : range.y == 1.0 ? 1.0 : 0.5 * (range.x + range.y);
    vec3 kept = mix(edge_start, edge_end, where);
    // Seen if it lies before the farthest of the four depths round it: one side of an outline is background.
    vec4 tests = textureGather(depth_map_tx, vec3((kept.xy + 0.5) / u_size_texels, u_layer), kept.z + kDepthRounding);
    if (max(max(tests.x, tests.y), max(tests.z, tests.w)) <= 0.0) discard;
    point = kept.xy - low;
}
