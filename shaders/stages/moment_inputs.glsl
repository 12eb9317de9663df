// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A receiver against a moment map: what the map says of its footprint, and the depth to ask about.
// Defines: MIPMAPS (0, 1: lookups average over the pixel's own footprint too), ANISOTROPIC (0, 1, with MIPMAPS: by the
// sampler, along the footprint's longer side).
//
// The footprint's texels lie on the receiver's own plane where nothing is between, spread round its depth by the
// plane's slope. No bias in scene units is needed to keep that plane from shading itself, only what follows from the
// kernel (`reach_texels`, `variance_texels`), the slope and rounding.
#include "stages/resolve_inputs.glsl"
#include "lib/linear_depth_lib.glsl"
#include "shared/moment_limits.h"

layout(binding = kMomentMapUnit) uniform sampler2DArray moment_map_tx;
layout(location = 0) uniform float u_stretches[kMaxViews];  // by layer, see linear_depth
layout(location = 6) uniform vec4 u_kernel;         // blur: variance per axis, radius; longest mipmapped side; kMapIs...
layout(location = 7) uniform float u_unit_roundoff;  // of the map's numbers, relative to 1

struct FilteredReceiver {
    vec4 moments;          // as stored, averaged
    float depth;           // -1 at near to 1 at far; moved towards the light by what rounding may have moved it away
    float variance;        // bound of the plane's depth's variance under the kernel, linearised
    float deviation;       // its standard deviation, towards the light
    float reach;           // the plane's farthest step towards the light under the kernel
    float texel_variance;  // of the plane's depth within one texel
};

// Lengths of a pixel's two sides in texels, on the receiver's plane. The neighbour on the nearer side is taken: the
// other one may lie on another surface.
vec2 find_pixel_side(ivec2 pixel, ivec2 axis, vec3 position_rel, mat4 lc_from_rel) {
    ivec2 last = textureSize(position_tx, 0) - 1;
    vec3 move = vec3(0);
    float nearest = 3.4e38;
    for (int side = -1; side <= 1; side += 2) {
        vec4 other = texelFetch(position_tx, clamp(pixel + side * axis, ivec2(0), last), 0);
        vec3 way = (other.xyz - position_rel) * float(side);
        float length_square = dot(way, way);
        bool better = other.w > 0.5 && length_square > 0.0 && length_square < nearest;
        move = better ? way : move;
        nearest = better ? length_square : nearest;
    }
    vec4 at = lc_from_rel * vec4(position_rel, 1.0), moved = lc_from_rel * vec4(move, 0.0);
    float inverse_w = at.w > 0.0 ? 1.0 / at.w : 0.0;
    return (moved.xy - at.xy * inverse_w * moved.w) * inverse_w * 0.5 * light.map.x;
}

struct PixelFootprint {
    vec2 side_x, side_y;  // texels, no longer than the mipmaps serve
    float longest;        // of all pixels of the 2 x 2 that a driver may give one level
};

vec2 limit_side(vec2 side, float longest) {
    float len = length(side);
    return len > longest ? side * (longest / len) : side;
}

float widest_of_quad(float value, ivec2 pixel) {
    value = max(value, value + ((pixel.x & 1) == 0 ? dFdxFine(value) : -dFdxFine(value)));
    return max(value, value + ((pixel.y & 1) == 0 ? dFdyFine(value) : -dFdyFine(value)));
}

PixelFootprint find_pixel_footprint(ivec2 pixel, Receiver receiver, int layer) {
    mat4 lc_from_rel = light.lc_from_rel[max(layer, 0)];
    PixelFootprint footprint;
    footprint.side_x = limit_side(find_pixel_side(pixel, ivec2(1, 0), receiver.position_rel, lc_from_rel), u_kernel.z);
    footprint.side_y = limit_side(find_pixel_side(pixel, ivec2(0, 1), receiver.position_rel, lc_from_rel), u_kernel.z);
    float own = max(max(length(footprint.side_x), length(footprint.side_y)), 1.0);
    footprint.longest = min(widest_of_quad(own, pixel), u_kernel.z);
    return footprint;
}

vec4 fetch_moments(MapPoint point, int layer, PixelFootprint footprint) {
    vec3 place = vec3(point.texel * light.map.y, max(layer, 0));
#if MIPMAPS && ANISOTROPIC
    return textureGrad(moment_map_tx, place, footprint.side_x * light.map.y, footprint.side_y * light.map.y);
#elif MIPMAPS
    return textureLod(moment_map_tx, place, log2(footprint.longest));
#else
    return textureLod(moment_map_tx, place, 0.0);
#endif
}

// Depth of the receiver's plane `step_rz` nearer to the light than depth_rz.
float depth_before(float depth_rz, float step_rz, float stretch) {
    return linear_depth(min(depth_rz + step_rz, 1.0), stretch);
}

FilteredReceiver filter_receiver(ivec2 pixel, Receiver receiver, int layer, MapPoint point) {
    FilteredReceiver filtered;
    float stretch = u_stretches[max(layer, 0)];
    PixelFootprint footprint = PixelFootprint(vec2(0), vec2(0), 1.0);
#if MIPMAPS
    footprint = find_pixel_footprint(pixel, receiver, layer);
#endif
    filtered.moments = fetch_moments(point, layer, footprint);

    // Between texel centres depths are interpolated: a kernel of two masses, with a variance of at most 1/4. A mipmap's
    // texel of side t adds the box's t^2 / 12 and puts the two masses t apart; a mix of two levels, up to a quarter more.
    float side = footprint.longest, level_side = exp2(ceil(log2(side)));
    float variance_texels = u_kernel.x + (side > 1.0 ? 0.42 * side * side : 0.25);
    float reach_texels = u_kernel.y + 1.5 * level_side - 0.5;

    // A sampler's weights may have eight bits, and the place in the map is rounded.
    float steepness = length(point.gradient), rise = abs(point.gradient.x) + abs(point.gradient.y);
    float depth_rz = max(point.depth_rz, 0.0) + point.rounding + rise / 256.0;
    // Texels of the plane beyond the far side are kept as far: where the kernel goes past it, averages are too near by
    // at most half of what is cut off.
    float cut_off = max(rise * reach_texels - depth_rz, 0.0);
    depth_rz = min(depth_rz + 0.5 * cut_off, 1.0);

    filtered.depth = linear_depth(depth_rz, stretch);
    float slope = steepness * linear_depth_slope(depth_rz, stretch);
    filtered.variance = slope * slope * variance_texels;
    filtered.reach = filtered.depth - depth_before(depth_rz, rise * reach_texels, stretch);
    float deviation_rz = min(steepness * sqrt(variance_texels) + 1.5 * cut_off, rise * reach_texels);
    filtered.deviation = filtered.depth - depth_before(depth_rz, deviation_rz, stretch);
    float texel_step = filtered.depth - depth_before(depth_rz, steepness, stretch);
    filtered.texel_variance = texel_step * texel_step / 12.0;
    return filtered;
}
