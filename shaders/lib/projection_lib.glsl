// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A receiver as the map sees it: place in texels, depth, the receiver plane's depth gradient, and what float costs.

struct MapPoint {
    vec2 texel;      // continuous; texel centres at +0.5
    float depth_rz;  // larger nearer to the light
    vec2 gradient;   // of depth_rz over one texel, on the receiver's plane
    float rounding;  // bound of the float error of depth_rz
};

// Any unit vector orthogonal to a unit vector; zero for a zero vector.
vec3 orthogonal_to(vec3 normal) {
    vec3 other = abs(normal.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    vec3 tangent = cross(normal, other);
    return tangent / max(length(tangent), 1e-30);
}

// Let P = M (p, 1) and q = P.xyz / P.w. Moving p by t moves q by (M3 t - q (w . t)) / P.w. The moves of two tangents
// span the receiver's plane in map space, whose normal is their cross product n; on it, dz/dx = -n.x / n.z and dz/dy =
// -n.y / n.z. A plane seen edge-on has n.z = 0: the gradient is then infinite, and is cut at `steepest` depth units
// per texel.
MapPoint project_receiver(mat4 lc_from_rel, vec3 position_rel, vec3 normal, float size_texels) {
    const float steepest = 1.0;
    vec4 position_lc = lc_from_rel * vec4(position_rel, 1.0);
    // Points beside or behind the light never ask the map; they only must not make NaNs.
    float inverse_w = position_lc.w > 0.0 ? 1.0 / position_lc.w : 0.0;
    vec3 ndc = clamp(position_lc.xyz * inverse_w, -1e4, 1e4);

    vec3 tangent = orthogonal_to(normal);
    vec3 bitangent = cross(normal, tangent);
    vec4 tangent_lc = lc_from_rel * vec4(tangent, 0.0);
    vec4 bitangent_lc = lc_from_rel * vec4(bitangent, 0.0);
    vec3 plane = cross(tangent_lc.xyz - ndc * tangent_lc.w, bitangent_lc.xyz - ndc * bitangent_lc.w);
    float texels_per_ndc = 0.5 * size_texels;

    MapPoint point;
    point.texel = (ndc.xy + 1.0) * texels_per_ndc;
    point.depth_rz = ndc.z;
    float run = max(abs(plane.z) * texels_per_ndc, 1e-30);
    point.gradient = clamp(plane.xy * (plane.z > 0.0 ? -1.0 : 1.0) / run, -steepest, steepest);

    // Each of the sums z and w carries a few roundings of its largest term; a map's own depths carry as many.
    const float units = 1.0 / 2097152.0;  // 2^-21: four roundings on each side
    vec4 weight = vec4(abs(position_rel), 1.0);
    vec4 row_z = vec4(lc_from_rel[0].z, lc_from_rel[1].z, lc_from_rel[2].z, lc_from_rel[3].z);
    vec4 row_w = vec4(lc_from_rel[0].w, lc_from_rel[1].w, lc_from_rel[2].w, lc_from_rel[3].w);
    point.rounding = units * abs(inverse_w) * (dot(abs(row_z), weight) + abs(ndc.z) * dot(abs(row_w), weight));
    return point;
}

// Depth to compare with the map at a texel's centre, `offset` texels from the receiver. The receiver's plane is
// followed only where it comes nearer to the light: following it away too would darken concave surfaces (algorithm B of
// docs/techniques/edsm.md). The slope of the caster is in the map already (stages/depth_map.h).
float reference_depth(MapPoint point, vec2 offset) {
    return max(point.depth_rz + max(dot(point.gradient, offset), 0.0) + point.rounding, 0.0);
}
