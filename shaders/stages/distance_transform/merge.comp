// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Joins the lists of two bands of columns. One thread per row takes columns from the right list's head and drops from
// the left list's tail what they make useless. Once two neighbours of the right list have survived side by side, the
// rest of it is as it was.
#include "lib/distance_transform_lib.glsl"

layout(local_size_x = 64) in;
layout(r16ui, binding = 0) readonly uniform uimage2D u_sites_img;
layout(r32ui, binding = 1) uniform uimage2D u_links_img;
layout(std430, binding = 0) buffer Ends { uint ends[]; };

uniform ivec2 u_size;
uniform int u_stride;  // bands between the two lists

Offer load_offer(uint x, int y) { return make_offer(int(x), imageLoad(u_sites_img, ivec2(y, int(x))).r, y); }
uint load_links(uint x, int y) { return imageLoad(u_links_img, ivec2(y, int(x))).r; }

/// Returns once the rest of the right list, from its column `right` on, hangs on the left list's column `last`.
void join(uint last, uint right, int y) {
    uint before_last = low_of(load_links(last, y)), taken_before = kNoIndex;
    while (right != kNoIndex) {
        Offer right_offer = load_offer(right, y), middle = load_offer(last, y);
        uint after = high_of(load_links(right, y));
        while (before_last != kNoIndex) {
            Offer left = load_offer(before_last, y);
            if (!is_useless(left, middle, right_offer)) break;
            last = before_last;
            middle = left;
            before_last = low_of(load_links(last, y));
        }
        imageStore(u_links_img, ivec2(y, int(last)), uvec4(pack_pair(before_last, right)));
        imageStore(u_links_img, ivec2(y, int(right)), uvec4(pack_pair(last, after)));
        if (last == taken_before) return;
        taken_before = right;
        before_last = last;
        last = right;
        right = after;
    }
}

void main() {
    int y = int(gl_GlobalInvocationID.x);
    if (y >= u_size.y) return;
    int left_end = int(gl_WorkGroupID.y) * 2 * u_stride * u_size.y + y, right_end = left_end + u_stride * u_size.y;
    uint left = ends[left_end], right = ends[right_end];
    if (low_of(right) == kNoIndex) return;
    if (low_of(left) == kNoIndex) {
        ends[left_end] = right;
        return;
    }
    join(high_of(left), low_of(right), y);
    // The right list's last column is never dropped, nor is the left one's first.
    ends[left_end] = pack_pair(low_of(left), high_of(right));
}
