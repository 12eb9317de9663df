// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Rows, within a band of columns: which columns' sites own a pixel of the row. One thread per row and band goes from
// left to right and keeps them as a stack; the stack is a doubly linked list in the image itself.
#include "lib/distance_transform_lib.glsl"

layout(local_size_x = 64) in;
layout(r16ui, binding = 0) readonly uniform uimage2D u_sites_img;  // (y, x)
layout(r32ui, binding = 1) uniform uimage2D u_links_img;           // (y, x): column before, column after
layout(std430, binding = 0) writeonly buffer Ends { uint ends[]; };  // [band][y]: first and last column of the list

uniform ivec2 u_size;
uniform int u_band_columns;

void main() {
    int y = int(gl_GlobalInvocationID.x);
    if (y >= u_size.y) return;
    int begin = int(gl_WorkGroupID.y) * u_band_columns, end = min(begin + u_band_columns, u_size.x);
    uint first = kNoIndex, before_last = kNoIndex, last = kNoIndex;
    Offer left = Offer(0, 0, 0), middle = left;  // of before_last and last
    for (int x = begin; x < end; ++x) {
        uint row = imageLoad(u_sites_img, ivec2(y, x)).r;
        if (row == kNoIndex) continue;
        Offer right = make_offer(x, row, y);
        while (before_last != kNoIndex && is_useless(left, middle, right)) {
            last = before_last;
            middle = left;
            before_last = low_of(imageLoad(u_links_img, ivec2(y, int(last))).r);
            if (before_last != kNoIndex)
                left = make_offer(int(before_last), imageLoad(u_sites_img, ivec2(y, int(before_last))).r, y);
        }
        if (last == kNoIndex)
            first = uint(x);
        else
            imageStore(u_links_img, ivec2(y, int(last)), uvec4(pack_pair(before_last, uint(x))));
        imageStore(u_links_img, ivec2(y, x), uvec4(pack_pair(last, kNoIndex)));
        before_last = last;
        left = middle;
        last = uint(x);
        middle = right;
    }
    ends[int(gl_WorkGroupID.y) * u_size.y + y] = pack_pair(first, last);
}
