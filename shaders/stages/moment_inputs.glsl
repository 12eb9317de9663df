// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A receiver against a moment map: what the map says of its footprint, and the depth to ask about.
// Defines: MIPMAPS (0, 1: lookups average over the pixel's own footprint too), ANISOTROPY (with MIPMAPS: most lookups
// along the footprint's longer side. They are made here and not by the sampler, whose lookups need not lie evenly round
// the receiver: an average off the middle of a slope is an average of other depths).
//
// The footprint's texels lie on the receiver's own plane where nothing is between, spread round its depth by the
// plane's slope. No bias in scene units is needed to keep that plane from shading itself, only what follows from the
// kernel (`radius_texels`, `variance_texels`), the slope and rounding.
#include "stages/resolve_inputs.glsl"
#include "lib/linear_depth_lib.glsl"
#include "shared/moment_limits.h"

layout(binding = kMomentMapUnit) uniform sampler2DArray moment_map_tx;
layout(location = 6) uniform vec3 u_kernel;  // variance of the blur per axis, its radius, longest mipmapped side
layout(location = 7) uniform float u_unit_roundoff;  // of the map's numbers, relative to 1
// Takes a location for each view: behind those of the techniques, which have 8 to 15.
layout(location = 16) uniform float u_relative_ranges[kMaxViews];  // by layer, see linear_depth

struct FilteredReceiver {
    vec4 moments;    // as stored, averaged
    float depth;     // moved towards the light by what rounding may have moved it away
    float variance;  // bound of the plane's depth's variance under the kernel, linearised
    float largest_rise;  // the plane's farthest step towards the light under the kernel
    float cut_off;   // most that its average loses because it ends at the far plane
};

// Lengths of a pixel's two sides in texels, on the receiver's plane. The neighbour on the nearer side is taken: the
// other one may lie on another surface.
vec2 find_pixel_side(ivec2 pixel, ivec2 axis, vec3 position_rel, mat4 lc_from_rel) {
    ivec2 last = textureSize(position_tx, 0) - 1;
    vec3 move = vec3(0);
    float nearest = 3.4e38;
    for (int side = -1; side <= 1; side += 2) {
        vec4 other = texelFetch(position_tx, clamp(pixel + side * axis, ivec2(0), last), 0);
        vec3 offset = (other.xyz - position_rel) * float(side);
        float length_square = dot(offset, offset);
        bool better = other.w > 0.5 && length_square > 0.0 && length_square < nearest;
        move = better ? offset : move;
        nearest = better ? length_square : nearest;
    }
    vec4 at = lc_from_rel * vec4(position_rel, 1.0), moved = lc_from_rel * vec4(move, 0.0);
    float inverse_w = at.w > 0.0 ? 1.0 / at.w : 0.0;
    return (moved.xy - at.xy * inverse_w * moved.w) * inverse_w * 0.5 * light.map.x;
}

// A pixel in the map: `count` lookups in a row along `longer`, each over a square of `side` texels.
struct PixelFootprint {
    vec2 longer;
    float side;  // of all pixels of the 2 x 2 that a driver may give one level
    int count;
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
    vec2 side_x = limit_side(find_pixel_side(pixel, ivec2(1, 0), receiver.position_rel, lc_from_rel), u_kernel.z);
    vec2 side_y = limit_side(find_pixel_side(pixel, ivec2(0, 1), receiver.position_rel, lc_from_rel), u_kernel.z);
    PixelFootprint footprint;
    footprint.longer = length(side_x) > length(side_y) ? side_x : side_y;
    float longest = max(length(footprint.longer), 1.0);
#if ANISOTROPY > 1
    float shortest = max(min(length(side_x), length(side_y)), 1.0);
    footprint.count = clamp(int(ceil(longest / shortest)), 1, ANISOTROPY);
#else
    footprint.count = 1;
#endif
    footprint.side = min(widest_of_quad(longest / float(footprint.count), pixel), u_kernel.z);
    return footprint;
}

vec4 fetch_moments(MapPoint point, int layer, PixelFootprint footprint) {
    vec4 sum = vec4(0);
    for (int k = 0; k < footprint.count; ++k) {
        vec2 texel = point.texel + footprint.longer * ((float(k) + 0.5) / float(footprint.count) - 0.5);
        sum += textureLod(moment_map_tx, vec3(texel * light.map.y, max(layer, 0)), log2(footprint.side));
    }
    return sum / float(footprint.count);
}

FilteredReceiver filter_receiver(ivec2 pixel, Receiver receiver, int layer, MapPoint point) {
    FilteredReceiver filtered;
    float relative_range = u_relative_ranges[max(layer, 0)];
#if MIPMAPS
    PixelFootprint footprint = find_pixel_footprint(pixel, receiver, layer);
    filtered.moments = fetch_moments(point, layer, footprint);
#else
    PixelFootprint footprint = PixelFootprint(vec2(0), 1.0, 1);
    filtered.moments = textureLod(moment_map_tx, vec3(point.texel * light.map.y, max(layer, 0)), 0.0);
#endif

    // Between texel centres depths are interpolated: a kernel of two masses, with a variance of at most 1/4. A mipmap's
    // texel of side t adds the box's t^2 / 12 and puts the two masses t apart; a mix of two levels, up to a quarter
    // more. Lookups in a row spread over a length.
    float side = footprint.side, row = footprint.count > 1 ? length(footprint.longer) : 0.0;
    float variance_texels = u_kernel.x + (side > 1.0 ? 0.42 * side * side : 0.25) + row * row / 12.0;
    float radius_texels = u_kernel.y + 1.5 * exp2(ceil(log2(side))) - 0.5 + 0.5 * row;

    // A sampler's weights may have eight bits, and the place in the map is rounded.
    float steepness = length(point.gradient), rise = abs(point.gradient.x) + abs(point.gradient.y);
    float depth_rz = min(max(point.depth_rz, 0.0) + point.rounding + rise / 256.0, 1.0);
    float slope = steepness * linear_depth_slope(depth_rz, relative_range);
    filtered.depth = linear_depth(depth_rz, relative_range);
    filtered.variance = slope * slope * variance_texels;
    filtered.largest_rise = filtered.depth - linear_depth(min(depth_rz + rise * radius_texels, 1.0), relative_range);
    float cut_off_rz = 0.5 * max(rise * radius_texels - depth_rz, 0.0);
    filtered.cut_off = filtered.depth - linear_depth(min(depth_rz + cut_off_rz, 1.0), relative_range);
    return filtered;
}
