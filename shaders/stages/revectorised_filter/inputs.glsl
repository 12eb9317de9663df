// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A kernel of revectorised visibilities: its receiver, its taps, and the depth test of any texel round them.
// Defines: KERNEL (taps per side), SPACING (texels from tap to tap), SMOOTH (0: v_SMSR, 1: v_RSMSS), CHANNELS (a
// constant of revectorisation_smooth_lib.glsl; SMOOTH only).
// Taps lie on whole texels from each other, so that all have the same place within their texel: [Macedo16] 3.4.
#include "stages/resolve_inputs.glsl"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(location = 0) uniform int u_walk_limit;

// How far beyond its taps a kernel looks before it walks: at neighbours, and with healed texels at theirs.
const int kRim = SMOOTH != 0 ? 2 : 1;
const int kExtent = (KERNEL - 1) * SPACING;  // texels from the first tap to the last

struct Kernel {
    Receiver receiver;
    MapPoint point;
    int layer;
    ivec2 first;  // texel of the lowest tap
    vec2 place;   // of each tap within its texel, 0..1
};

Kernel kernel;

void fetch_kernel(ivec2 pixel) {
    kernel.receiver = fetch_receiver(pixel);
    kernel.layer = choose_layer(kernel.receiver);
    kernel.point = locate_in_map(kernel.receiver, kernel.layer);
    // With an even number of taps the receiver lies between two of them.
    vec2 base = kernel.point.texel - 0.5 * float(kExtent & 1);
    vec2 corner = floor(base);
    kernel.place = base - corner;
    kernel.first = ivec2(corner) - kExtent / 2;
}

bool is_texel_lit(ivec2 texel) {
    vec2 centre = vec2(texel) + 0.5;
    float reference = reference_depth(kernel.point, centre - kernel.point.texel);
    return texture(depth_map_tx, vec4(centre * light.map.y, kernel.layer, reference)) > 0.5;
}
