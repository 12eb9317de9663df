// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "shared/edge_map.h"

// Depths as the edge distance map keeps them, in half floats. depth_rz = near (far - w) / ((far - near) w) lies round
// near / w: with the near plane at 1e-6 of the far one, as where a caster touches a point light, all but the nearest
// edges are below the smallest half float. Times far / near - 1 it is far / w - 1, from 0 at the far plane on: half
// floats then hold all but what lies at less than far / kGreatestEdgeDepth from the light, where depths count as equal.
// A parallel view's depths run from 0 to 1 evenly and stay as they are.

// far / near - 1 of a perspective view, 1 of a parallel one. Both rows are multiples of the view's axis, by -1 and by
// near / (far - near); the w row of a parallel view is zero. techniques/edsm/edge_distance_map.h has it from the view.
float edge_depth_scale(mat4 lc_from_rel) {
    vec3 row_z = vec3(lc_from_rel[0].z, lc_from_rel[1].z, lc_from_rel[2].z);
    vec3 row_w = vec3(lc_from_rel[0].w, lc_from_rel[1].w, lc_from_rel[2].w);
    return max(length(row_w) / max(length(row_z), 1e-30), 1.0);
}

float encode_edge_depth(float depth_rz, float scale) { return min(depth_rz * scale, kGreatestEdgeDepth); }
