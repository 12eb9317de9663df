// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Columns, within a band of rows: each pixel gets the row of the nearest site of its column and band. One thread per
// column and band; neighbours in x run side by side.
#include "lib/distance_transform_lib.glsl"

layout(local_size_x = 64) in;
layout(r32ui, binding = 0) uniform uimage2D u_rows_img;

#if MASK_IS_UINT
uniform usampler2D u_mask_tx;
#else
uniform sampler2D u_mask_tx;
#endif
uniform ivec2 u_size;
uniform int u_band_rows;

void main() {
    int x = int(gl_GlobalInvocationID.x);
    if (x >= u_size.x) return;
    int begin = int(gl_WorkGroupID.y) * u_band_rows, end = min(begin + u_band_rows, u_size.y);
    uint below = kNoIndex;
    for (int y = begin; y < end; ++y) {
        if (texelFetch(u_mask_tx, ivec2(x, y), 0).r != 0) below = uint(y);
        imageStore(u_rows_img, ivec2(x, y), uvec4(below));
    }
    uint above = kNoIndex;
    for (int y = end - 1; y >= begin; --y) {
        below = imageLoad(u_rows_img, ivec2(x, y)).r;
        if (below == uint(y))
            above = below;
        else if (above != kNoIndex && (below == kNoIndex || above - uint(y) < uint(y) - below))
            imageStore(u_rows_img, ivec2(x, y), uvec4(above));
    }
}
