// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the receivers of a texel against one caster. Where a condition is nearer to zero than its error's bound (or is
// not a number) the pair is left open.
#include "techniques/afsm/receiver_list.h"

layout(early_fragment_tests) in;
layout(r32ui, binding = kListHeadUnit) readonly uniform uimage2D u_head_img;
layout(std430, binding = kListReceiversSlot) readonly buffer Receivers { ListReceiver receivers[]; };
layout(std430, binding = kListNextSlot) readonly buffer Next { uint next[]; };
layout(std430, binding = kListBlockedSlot) buffer Blocked { uint blocked[]; };
layout(std430, binding = kListCountsSlot) buffer Counts { ListCounts counts; };
layout(std430, binding = kListOpenSlot) writeonly buffer Open { uvec2 open_pairs[]; };

uniform uint u_open_capacity;
uniform float u_largest_place_error;  // texels

flat in vec4 edge_0, edge_1, edge_2, depth_form;
flat in ivec2 middle;
flat in uvec2 ids;
flat in uint number;

// Five roundings of 2^-24 of each term, with a reserve.
const float kFloatError = 1.0 / 2097152.0;
// Hits this near to the plane are settled in double too, where the receiver's flat neighbours are known.
const float kContact = 1e-5;

struct TexelForm {
    float at, slope, error;
};

TexelForm move_form(vec4 form, vec2 steps) {
    TexelForm moved;
    moved.at = form.x + form.y * steps.x + form.z * steps.y;
    moved.slope = abs(form.y) + abs(form.z);
    vec2 extent = abs(steps) + 1.0;
    moved.error = kFloatError * (abs(form.x) + abs(form.y) * extent.x + abs(form.z) * extent.y) + form.w;
    return moved;
}

bool is_outside(TexelForm form) {
    return form.at + form.slope * (0.5 + u_largest_place_error) + 2.0 * form.error < 0.0;
}

// Above 0: holds for sure; below 0: surely not; 0: open.
int decide(TexelForm moved, vec4 form, ListReceiver receiver, float subtracted, float further_error) {
    float value = moved.at + form.y * receiver.x + form.z * receiver.y - subtracted;
    float error = moved.error + moved.slope * receiver.place_error + further_error;
    return value > error ? 1 : value < -error ? -1 : 0;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec2 steps = vec2(texel - middle);
    TexelForm e0 = move_form(edge_0, steps), e1 = move_form(edge_1, steps), e2 = move_form(edge_2, steps);
    TexelForm plane = move_form(depth_form, steps);
    bool touched = !(is_outside(e0) || is_outside(e1) || is_outside(e2));
    uint link = touched ? imageLoad(u_head_img, texel).r : kListEnd;
    uint tests = 0u;
    while (link != kListEnd) {
        uint node = link - 1u;
        link = next[node];
        ListReceiver receiver = receivers[node];
        // Never in the shadow of its own triangle.
        if (blocked[node] != 0u || uvec2(receiver.instance, receiver.triangle) == ids) continue;
        ++tests;
        float depth_error = receiver.depth_error + (kContact + kFloatError) * (abs(plane.at) + abs(receiver.depth));
        int inside = min(min(decide(e0, edge_0, receiver, 0.0, 0.0), decide(e1, edge_1, receiver, 0.0, 0.0)),
                         min(decide(e2, edge_2, receiver, 0.0, 0.0),
                             decide(plane, depth_form, receiver, receiver.depth, depth_error)));
        if (inside > 0) blocked[node] = 1u;
        if (inside != 0) continue;
        uint place = atomicAdd(counts.open_pairs, 1u);
        if (place < u_open_capacity) open_pairs[place] = uvec2(node, number);
    }
    if (tests == 0u) return;
    uint before = atomicAdd(counts.tests_low, tests);
    if (before + tests < before) atomicAdd(counts.tests_high, 1u);
}
