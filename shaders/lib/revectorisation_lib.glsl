// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Revectorisation of the steps that a shadow map's texels make: where the test of a texel disagrees with a neighbour's,
// the run of such texels is walked to both of its ends, and the border becomes the line from end to end.
// Based on: [Macedo16] 3.1, 3.2 and its supplement's case list (12 cases), in the unified form of one rule per run;
// [Bondarev14]; the later reduced form of [Macedo16]'s author.
// Differences: runs that are open or closed at both ends are completed (d = 0, d = 1), so that no case is special; the
// side that shadow comes from never decides by its name.
//
// How to include: declare nothing, define
//     bool is_texel_lit(ivec2 texel)    the depth test of your fragment against any texel; must answer beyond the rim
// anywhere in the shader (it is declared below), then call, for the texel of a fragment and its place in it (0..1)^2,
//     uint code = look_at(texel, kAllSides, kAsTested);
//     smsr_visibility(code, texel, place, limit)           0 or 1; shadow is only ever added
//     reduced_visibility(code, texel, place, limit)        likewise, by the reduced form
//     half_level_visibility(code, texel, place, limit)     0 or 1; the border is the steps' middle line, unbiased
//     rsmss_...visibility(...)                             see revectorisation_smooth_lib.glsl
// `limit` is the longest walk in texels: a call looks at most limit + 1 texels away from its own (limit + 2 with
// kHealed). A code without sides needs no call: the visibility is that of the texel. A shader that knows codes without
// testing (a discontinuity map) defines REVECTORISATION_OWN_LOOK and then look_at itself, by test_sides where it must.

#include "lib/discontinuity_code_lib.glsl"

const bool kAsTested = false;
const bool kHealed = true;  // a texel that all four neighbours contradict takes their side

bool is_texel_lit(ivec2 texel);

// Written as loops throughout: a software rasteriser skips loops without trips, but no branch, and each place that tests
// a texel is compiled anew.
bool is_lit(ivec2 texel, bool healed) {
    bool lit = is_texel_lit(texel);
    bool alone = healed;
    for (uint left = healed ? kAllSides : 0u; left != 0u && alone; left &= left - 1u)
        alone = is_texel_lit(texel + step_over(lowest(left))) != lit;
    return lit != alone;
}

// [Macedo16] 3.1: the discontinuities d_u of a texel, of those asked for by `sides`, and its own test.
uint test_sides(ivec2 texel, uint sides, bool healed) {
    bool lit = is_lit(texel, healed);
    uint code = lit ? kLitTexel : 0u;
    for (uint left = sides; left != 0u; left &= left - 1u)
        if (is_lit(texel + step_over(lowest(left)), healed) != lit) code |= lowest(left);
    return code;
}
#ifdef REVECTORISATION_OWN_LOOK
uint look_at(ivec2 texel, uint sides, bool healed);
#else
uint look_at(ivec2 texel, uint sides, bool healed) { return test_sides(texel, sides, healed); }
#endif

// How far the sample is from one side of its texel, in texels.
float side_depth(uint side, vec2 place) {
    if (side == kLeft) return place.x;
    if (side == kRight) return 1.0 - place.x;
    return side == kTop ? place.y : 1.0 - place.y;
}

bool goes_on(uint code, uint sides, bool lit) { return has_any(code, kLitTexel) == lit && has_any(code, sides); }

// Steps to where a run ends (> 0: the test changes) or begins (< 0: none of its sides goes on). [Macedo16]: alpha.
// Healing is looked into only where something changes: a texel that is like the one before it, with sides that are like
// those before them, has neighbours like itself.
int walk(ivec2 texel, ivec2 along, uint sides, bool lit, bool healed, int limit) {
    int steps = -(limit + 1);
    uint before = 0u;  // code of the step before; 0, which no walk goes on from: not to be relied upon
    for (int n = 1; n <= limit; ++n) {
        uint code = look_at(texel + n * along, sides, kAsTested);
        while (n < limit && goes_on(code, sides, lit) && (!healed || code == before)) {
            ++n;
            code = look_at(texel + n * along, sides, kAsTested);
        }
        uint seen = code;
        for (int k = healed ? 0 : 1; k < 1; ++k) seen = look_at(texel + n * along, sides, kHealed);
        before = seen == code ? code : 0u;
        if (!goes_on(seen, sides, lit)) {
            steps = has_any(seen, kLitTexel) != lit ? n : -n;
            break;
        }
    }
    return steps;
}

// A run, as its sample sees it.
struct Run {
    float done;     // [Macedo16] Eq. 1: from the run's beginning to its end, 0..1; completed where it lacks one
    float nearest;  // distance to the nearest end, as a part of the run's length; of closed runs only
    bool closed;    // an end on both sides
    bool open;      // none
};

// `forward` and `backward`: what walk() says along + and -; `at`: the sample's coordinate in its texel along the run.
Run make_run(int forward, int backward, float at, int limit) {
    Run run;
    run.closed = forward > 0 && backward > 0;
    run.open = forward < 0 && backward < 0;
    float texels = float(min(abs(forward) + abs(backward) - 1, limit));
    float to_forward = float(forward) - at, to_backward = float(backward) - 1.0 + at;
    run.done = run.closed ? 1.0 : run.open ? 0.0 : (texels - (forward > 0 ? to_forward : to_backward)) / texels;
    run.nearest = min(to_forward, to_backward) / texels;
    return run;
}

// The run that carries `sides` (of one axis), walked along the other axis; without trips where there are none.
Run follow_run(ivec2 texel, uint sides, bool lit, bool healed, vec2 place, int limit) {
    bool along_x = has_any(sides, kSidesY);
    ivec2 along = along_x ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 steps = ivec2(-1);
    for (int k = sides != 0u ? 0 : 2; k < 2; ++k) {
        int found = walk(texel, k == 0 ? along : -along, sides, lit, healed, limit);
        steps = k == 0 ? ivec2(found) : ivec2(steps.x, found);
    }
    return make_run(steps.x, steps.y, along_x ? place.x : place.y, limit);
}

// Of a texel with one side on each axis: which runs count? x: the one along x (its side is top or bottom), y: that along
// y. Looked at one texel away from each discontinuity; if neither goes on, the run along x stands for both.
bvec2 find_dominant(ivec2 texel, uint sides, bool healed) {
    uint side_x = sides & kSidesX, side_y = sides & kSidesY;
    bvec2 on = bvec2(false);
    for (int k = side_x != 0u && side_y != 0u ? 0 : 2; k < 2; ++k) {
        uint across = k == 0 ? kSidesY : kSidesX;
        bool found = has_any(look_at(texel - step_over(k == 0 ? side_x : side_y), across, healed), across);
        on = k == 0 ? bvec2(found, false) : bvec2(on.x, found);
    }
    return bvec2(on.x || !on.y, on.y);
}

bool is_channel(uint sides) { return has_all(sides, kSidesX) || has_all(sides, kSidesY); }
bool is_corner(uint sides) { return has_any(sides, kSidesX) && has_any(sides, kSidesY) && !is_channel(sides); }

// [Macedo16] 3.2: v_SMSR. Shadow iff the run has come farther than the sample is deep, on an axis that counts.
float smsr_visibility(uint code, ivec2 texel, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    uint sides = lit && !is_channel(code) ? code & kAllSides : 0u;
    uint first = has_any(sides, kSidesY) ? sides & kSidesY : sides;  // the run along x has its side on the y axis
    uint second = sides & ~first;
    bvec2 counts = second != 0u ? find_dominant(texel, sides, kAsTested) : bvec2(true, false);
    bool dark = false;
    int runs = first == 0u ? 0 : second == 0u ? 1 : 2;
    for (int k = 0; k < runs; ++k) {
        uint side = k == 0 ? first : second;
        Run run = follow_run(texel, side, lit, kAsTested, place, limit);
        dark = dark || ((k == 0 ? counts.x : counts.y) && run.done > side_depth(side, place)) ||
               (second != 0u && run.closed);
    }
    return lit && !is_channel(code) && !dark ? 1.0 : 0.0;
}

// The distance to the end along one axis, as a part of that between both stops of the walk; across a lone discontinuity
// that is the depth of its side. 0: no end on either side.
float way_to_end(int forward, int backward, float at, int limit) {
    float to_forward = float(abs(forward)) - at, to_backward = float(abs(backward)) - 1.0 + at;
    float whole = min(to_forward + to_backward, float(limit));
    if (forward > 0 && backward > 0) return min(2.0 * min(to_forward, to_backward) / whole, 1.0);
    return forward > 0 ? min(to_forward / whole, 1.0) : backward > 0 ? min(to_backward / whole, 1.0) : 0.0;
}

// Walked until the test changes, or a texel without any side comes.
vec2 distances_to_ends(ivec2 texel, uint code, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    ivec4 steps = ivec4(-1);  // right, left, bottom, top
    for (int k = has_any(code, kAllSides) ? 0 : 4; k < 4; ++k) {
        ivec2 along = step_over(k < 2 ? (k == 0 ? kRight : kLeft) : (k == 2 ? kBottom : kTop));
        int found = walk(texel, along, kAllSides, lit, kAsTested, limit);
        steps = ivec4(k == 0 ? found : steps.x, k == 1 ? found : steps.y, k == 2 ? found : steps.z, found);
    }
    return vec2(way_to_end(steps.x, steps.y, place.x, limit), way_to_end(steps.z, steps.w, place.y, limit));
}

// The reduced form: one chamfer from end to end, no dominance.
float reduced_visibility(uint code, ivec2 texel, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    vec2 distances = distances_to_ends(texel, lit ? code : 0u, place, limit);
    bool dark = is_channel(code) || (distances.x * distances.y > 0.0 && distances.x + distances.y < 1.0);
    return lit && !dark ? 1.0 : 0.0;
}

// The reduced form's ramp, cut at one half on both sides of the border. A run without an end leaves its texel alone.
float half_level_visibility(uint code, ivec2 texel, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    vec2 distances = distances_to_ends(texel, code, place, limit);
    bool turned = distances.x * distances.y > 0.0 && distances.x + distances.y < 0.5;
    return lit != turned ? 1.0 : 0.0;
}
