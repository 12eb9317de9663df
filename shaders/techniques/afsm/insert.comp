// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Puts receivers of a view into the lists of its texels, and keeps each texel's farthest depth.
#include "techniques/afsm/receiver_list.h"

layout(local_size_x = kInsertGroup) in;
layout(r32ui, binding = kListHeadUnit) uniform uimage2D u_head_img;
layout(r32ui, binding = kListFarthestUnit) uniform uimage2D u_farthest_img;
layout(std430, binding = kListReceiversSlot) readonly buffer Receivers { ListReceiver receivers[]; };
layout(std430, binding = kListNextSlot) writeonly buffer Next { uint next[]; };

uniform uint u_count;  // of receivers
uniform uint u_side;   // of the map

void main() {
    uint node = gl_GlobalInvocationID.x;
    if (node >= u_count) return;
    ivec2 texel = ivec2(receivers[node].texel % u_side, receivers[node].texel / u_side);
    next[node] = imageAtomicExchange(u_head_img, texel, node + 1u);
    // Floats that are not negative have the order of their bits.
    float depth = max(receivers[node].depth - receivers[node].depth_error, 0.0);
    imageAtomicMin(u_farthest_img, texel, floatBitsToUint(depth));
}
