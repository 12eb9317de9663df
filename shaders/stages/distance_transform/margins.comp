// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// For each column and band of rows: the nearest sites below and above the band. The last row of a band below knows the
// highest site in it, the first row of a band above the lowest.
#include "lib/distance_transform_lib.glsl"

layout(local_size_x = 64) in;
layout(r32ui, binding = 0) readonly uniform uimage2D u_rows_img;
layout(std430, binding = 0) writeonly buffer Margins { uint margins[]; };  // [band][x], below and above packed

uniform ivec2 u_size;
uniform int u_band_rows;
uniform int u_band_count;

void main() {
    int x = int(gl_GlobalInvocationID.x);
    if (x >= u_size.x) return;
    int band = int(gl_WorkGroupID.y);
    uint below = kNoIndex, above = kNoIndex;
    for (int other = band - 1; other >= 0 && below == kNoIndex; --other)
        below = imageLoad(u_rows_img, ivec2(x, (other + 1) * u_band_rows - 1)).r;
    for (int other = band + 1; other < u_band_count && above == kNoIndex; ++other)
        above = imageLoad(u_rows_img, ivec2(x, other * u_band_rows)).r;
    margins[band * u_size.x + x] = pack_pair(below, above);
}
