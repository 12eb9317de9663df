// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Each pixel's nearest site. A group works on 32 rows, a tile at a time from right to left; the threads of a row share
// its pixels, and each walks the row's list back with a cursor of its own. Tiles are written with x and y exchanged.
#include "lib/distance_transform_lib.glsl"
#include "lib/nearest_site_lib.glsl"

layout(local_size_x = 32, local_size_y = 8) in;
layout(r16ui, binding = 0) readonly uniform uimage2D u_sites_img;
layout(r32ui, binding = 1) readonly uniform uimage2D u_links_img;
layout(r32ui, binding = 2) writeonly uniform uimage2D u_nearest_img;
layout(std430, binding = 0) readonly buffer Ends { uint ends[]; };

uniform ivec2 u_size;
uniform int u_bound;

const int kTile = 32;
shared uint tile[kTile][kTile + 1];

// The cursor: the column in hand and the one before it.
uint here_x, before_x;
Offer here, before;

void load_before(int y) {
    before_x = low_of(imageLoad(u_links_img, ivec2(y, int(here_x))).r);
    if (before_x != kNoIndex) before = make_offer(int(before_x), imageLoad(u_sites_img, ivec2(y, int(before_x))).r, y);
}

void start(int y) {
    here_x = before_x = kNoIndex;
    here = before = Offer(0, 0, 0);
    if (y >= u_size.y) return;
    here_x = high_of(ends[y]);
    if (here_x == kNoIndex) return;
    here = make_offer(int(here_x), imageLoad(u_sites_img, ivec2(y, int(here_x))).r, y);
    load_before(y);
}

uint find_nearest(int x, int y) {
    if (here_x == kNoIndex) return kNoSite;
    while (before_x != kNoIndex && !wins(here, before, x)) {
        here_x = before_x;
        here = before;
        load_before(y);
    }
    return offer_square(here, x) <= u_bound * u_bound ? pack_site(ivec2(here.x, here.site_y)) : kNoSite;
}

void main() {
    ivec2 local = ivec2(gl_LocalInvocationID.xy);
    int group_y = int(gl_WorkGroupID.x) * kTile, y = group_y + local.x;
    start(y);
    for (int tile_x = (u_size.x - 1) / kTile * kTile; tile_x >= 0; tile_x -= kTile) {
        for (int k = local.y; k < kTile; k += int(gl_WorkGroupSize.y)) {
            int x = tile_x + kTile - 1 - k;
            if (x < u_size.x && y < u_size.y) tile[kTile - 1 - k][local.x] = find_nearest(x, y);
        }
        barrier();
        for (int k = local.y; k < kTile; k += int(gl_WorkGroupSize.y)) {
            ivec2 pixel = ivec2(tile_x + local.x, group_y + k);
            if (all(lessThan(pixel, u_size))) imageStore(u_nearest_img, pixel, uvec4(tile[local.x][k]));
        }
        barrier();
    }
}
