// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Each pixel's nearest row among its band's and the margins', kNoIndex beyond the bound; written with x and y exchanged,
// a tile at a time, so that the passes along rows read neighbours in y side by side.
#include "lib/distance_transform_lib.glsl"

layout(local_size_x = 32, local_size_y = 8) in;
layout(r32ui, binding = 0) readonly uniform uimage2D u_rows_img;
layout(r16ui, binding = 1) writeonly uniform uimage2D u_sites_img;  // (y, x)
layout(std430, binding = 0) readonly buffer Margins { uint margins[]; };

uniform ivec2 u_size;
uniform int u_band_rows;
uniform int u_bound;

const int kTile = 32;
shared uint tile[kTile][kTile + 1];  // one more, so that columns lie in different banks

uint find_row(ivec2 pixel) {
    uint y = uint(pixel.y), row = imageLoad(u_rows_img, pixel).r;
    uint margin = margins[(pixel.y / u_band_rows) * u_size.x + pixel.x];
    uint below = low_of(margin), above = high_of(margin);
    uint apart = row == kNoIndex ? kNoIndex : uint(abs(int(row) - pixel.y));
    // A tie goes to the lower row: the margin below comes first, the one above last.
    if (below != kNoIndex && y - below <= apart) {
        row = below;
        apart = y - below;
    }
    if (above != kNoIndex && above - y < apart) {
        row = above;
        apart = above - y;
    }
    return apart <= uint(u_bound) ? row : kNoIndex;
}

void main() {
    ivec2 corner = ivec2(gl_WorkGroupID.xy) * kTile, local = ivec2(gl_LocalInvocationID.xy);
    for (int k = local.y; k < kTile; k += int(gl_WorkGroupSize.y)) {
        ivec2 pixel = corner + ivec2(local.x, k);
        if (all(lessThan(pixel, u_size))) tile[k][local.x] = find_row(pixel);
    }
    barrier();
    for (int k = local.y; k < kTile; k += int(gl_WorkGroupSize.y)) {
        ivec2 pixel = corner + ivec2(k, local.x);
        if (all(lessThan(pixel, u_size))) imageStore(u_sites_img, pixel.yx, uvec4(tile[local.x][k]));
    }
}
