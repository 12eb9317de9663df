// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The depth that a caster must pass to be tested in a texel: its farthest receiver's; nothing passes an empty texel.
#include "techniques/afsm/receiver_list.h"

layout(r32ui, binding = kListHeadUnit) readonly uniform uimage2D u_head_img;
layout(r32ui, binding = kListFarthestUnit) readonly uniform uimage2D u_farthest_img;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float farthest = min(uintBitsToFloat(imageLoad(u_farthest_img, texel).r), 1.0 - 1.0 / 1048576.0);
    gl_FragDepth = imageLoad(u_head_img, texel).r == kListEnd ? 1.0 : farthest;
}
