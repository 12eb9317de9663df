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
// testing (a discontinuity map) defines REVECTORISATION_OWN_LOOK and look_at itself.

const uint kLeft = 1u;     // -x; bits of a code: sides where the neighbour's test differs
const uint kRight = 2u;    // +x
const uint kTop = 4u;      // -y: the names of [Macedo16]
const uint kBottom = 8u;   // +y
const uint kSidesX = 3u;
const uint kSidesY = 12u;
const uint kAllSides = 15u;
const uint kLitTexel = 16u;  // bit: the texel's own test

const bool kAsTested = false;
const bool kHealed = true;  // a texel that all four neighbours contradict takes their side

bool is_texel_lit(ivec2 texel);

#ifndef REVECTORISATION_OWN_LOOK
// Four loops' worth of tests where only healed ones are asked for.
bool is_lit(ivec2 texel, bool healed) {
    bool lit = is_texel_lit(texel);
    if (!healed) return lit;
    bool alone = is_texel_lit(texel + ivec2(-1, 0)) != lit && is_texel_lit(texel + ivec2(1, 0)) != lit &&
                 is_texel_lit(texel + ivec2(0, -1)) != lit && is_texel_lit(texel + ivec2(0, 1)) != lit;
    return lit != alone;
}

// [Macedo16] 3.1: the discontinuities d_u of a texel, of those asked for by `sides`, and its own test.
uint look_at(ivec2 texel, uint sides, bool healed) {
    bool lit = is_lit(texel, healed);
    uint code = lit ? kLitTexel : 0u;
    if ((sides & kLeft) != 0u && is_lit(texel + ivec2(-1, 0), healed) != lit) code |= kLeft;
    if ((sides & kRight) != 0u && is_lit(texel + ivec2(1, 0), healed) != lit) code |= kRight;
    if ((sides & kTop) != 0u && is_lit(texel + ivec2(0, -1), healed) != lit) code |= kTop;
    if ((sides & kBottom) != 0u && is_lit(texel + ivec2(0, 1), healed) != lit) code |= kBottom;
    return code;
}
#else
uint look_at(ivec2 texel, uint sides, bool healed);
#endif

bool has_all(uint code, uint sides) { return (code & sides) == sides; }
bool has_any(uint code, uint sides) { return (code & sides) != 0u; }

// How far the sample is from one side of its texel, in texels.
float side_depth(uint side, vec2 place) {
    if (side == kLeft) return place.x;
    if (side == kRight) return 1.0 - place.x;
    return side == kTop ? place.y : 1.0 - place.y;
}

// Steps to where a run ends (> 0: the test changes) or begins (< 0: none of its sides goes on). [Macedo16]: alpha.
int walk(ivec2 texel, ivec2 along, uint sides, bool lit, bool healed, int limit) {
    int steps = -(limit + 1);
    for (int n = 1; n <= limit; ++n) {
        uint code = look_at(texel + n * along, sides, healed);
        bool is_end = has_any(code, kLitTexel) != lit;
        if (is_end || !has_any(code, sides)) {
            steps = is_end ? n : -n;
            break;
        }
    }
    return steps;
}

// A run, as its sample sees it.
struct Run {
    float done;     // [Macedo16] Eq. 1: from the run's beginning to its end, 0..1; completed where it lacks one
    float nearest;  // way to the nearest end, of the run's length; of closed runs only
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
    int reach = sides != 0u ? limit : 0;
    int forward = walk(texel, along, sides, lit, healed, reach);
    int backward = walk(texel, -along, sides, lit, healed, reach);
    return make_run(forward, backward, along_x ? place.x : place.y, max(limit, 1));
}

// Of a texel with one side on each axis: which runs count? x: the one along x (its side is top or bottom), y: that along
// y. Looked at one texel away from each discontinuity; if neither goes on, the run along x stands for both.
bvec2 find_dominant(ivec2 texel, uint sides, bool healed) {
    ivec2 away_x = ivec2(has_any(sides, kLeft) ? 1 : -1, 0);
    ivec2 away_y = ivec2(0, has_any(sides, kTop) ? 1 : -1);
    bool goes_on_x = has_any(look_at(texel + away_x, kSidesY, healed), kSidesY);
    bool goes_on_y = has_any(look_at(texel + away_y, kSidesX, healed), kSidesX);
    return bvec2(goes_on_x || !goes_on_y, goes_on_y);
}

bool is_channel(uint sides) { return has_all(sides, kSidesX) || has_all(sides, kSidesY); }
bool is_corner(uint sides) { return has_any(sides, kSidesX) && has_any(sides, kSidesY) && !is_channel(sides); }

// [Macedo16] 3.2: v_SMSR. Shadow iff the run has come farther than the sample is deep, on an axis that counts.
float smsr_visibility(uint code, ivec2 texel, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    uint sides = lit && !is_channel(code) ? code & kAllSides : 0u;
    uint side_of_x = sides & kSidesY, side_of_y = sides & kSidesX;  // of the runs along x and y
    uint first = side_of_x != 0u ? side_of_x : side_of_y;
    uint second = side_of_x != 0u ? side_of_y : 0u;
    Run first_run = follow_run(texel, first, lit, kAsTested, place, limit);
    Run second_run = follow_run(texel, second, lit, kAsTested, place, limit);
    bvec2 counts = bvec2(first != 0u, false);
    // A loop, because a software rasteriser skips one without trips, but no branch.
    for (int corner = second != 0u ? 0 : 1; corner < 1; ++corner) counts = find_dominant(texel, sides, kAsTested);
    bool dark = (counts.x && first_run.done > side_depth(first, place)) ||
                (counts.y && second_run.done > side_depth(second, place)) ||
                (second != 0u && (first_run.closed || second_run.closed));
    return lit && !is_channel(code) && !dark ? 1.0 : 0.0;
}

// The way to the end along one axis, of the way between both stops of the walk; across a lone discontinuity that is the
// depth of its side. 0: no end either way.
float way_to_end(int forward, int backward, float at, int limit) {
    float to_forward = float(abs(forward)) - at, to_backward = float(abs(backward)) - 1.0 + at;
    float whole = min(to_forward + to_backward, float(limit));
    if (forward > 0 && backward > 0) return min(2.0 * min(to_forward, to_backward) / whole, 1.0);
    return forward > 0 ? min(to_forward / whole, 1.0) : backward > 0 ? min(to_backward / whole, 1.0) : 0.0;
}

// Walked until the test changes, or a texel without any side comes.
vec2 ways_to_ends(ivec2 texel, uint code, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    int reach = has_any(code, kAllSides) ? limit : 0;
    int right = walk(texel, ivec2(1, 0), kAllSides, lit, kAsTested, reach);
    int left = walk(texel, ivec2(-1, 0), kAllSides, lit, kAsTested, reach);
    int bottom = walk(texel, ivec2(0, 1), kAllSides, lit, kAsTested, reach);
    int top = walk(texel, ivec2(0, -1), kAllSides, lit, kAsTested, reach);
    return vec2(way_to_end(right, left, place.x, limit), way_to_end(bottom, top, place.y, limit));
}

// The reduced form: one chamfer from end to end, no dominance.
float reduced_visibility(uint code, ivec2 texel, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    vec2 ways = ways_to_ends(texel, lit ? code : 0u, place, limit);
    bool dark = is_channel(code) || (ways.x * ways.y > 0.0 && ways.x + ways.y < 1.0);
    return lit && !dark ? 1.0 : 0.0;
}

// The reduced form's ramp, cut at one half on both sides of the border. A run without an end leaves its texel alone.
float half_level_visibility(uint code, ivec2 texel, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    vec2 ways = ways_to_ends(texel, code, place, limit);
    bool turned = ways.x * ways.y > 0.0 && ways.x + ways.y < 0.5;
    return lit != turned ? 1.0 : 0.0;
}
