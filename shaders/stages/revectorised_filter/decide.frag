// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// First of two programs: decides the pixels that need no map, and those where no test in the kernel and its rim
// differs, for without discontinuities a revectorised kernel is the plain one. Leaves the others.
// Defines: those of inputs.glsl; EARLY_OUT (0: only the pixels that need no map).
#include "stages/revectorised_filter/inputs.glsl"
#include "stages/depth_range.glsl"

layout(location = 1) uniform float u_radius_texels;
layout(location = 0) out float visibility;

void main() {
    fetch_kernel(ivec2(gl_FragCoord.xy));
    vec2 first = vec2(kernel.first - kRim);
    float decided = EARLY_OUT != 0 ? decide_taps(kernel.point, kernel.layer, first,
                                                 first + float(kExtent + 2 * kRim), u_radius_texels)
                                   : kWindowMixed;
    bool map_decides = kernel.receiver.fixed_visibility == kMapDecides && kernel.layer >= 0;
    if (map_decides && decided == kWindowMixed) discard;
    visibility = combine_visibility(kernel.receiver, kernel.layer, decided);
}
