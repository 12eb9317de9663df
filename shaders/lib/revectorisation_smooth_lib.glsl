// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Revectorisation with smoothed borders: a ramp one texel wide, measured across the run, whose half is the line through
// the middles of the steps.
// Based on: [Macedo16] 3.3 and its supplement's case list (31 cases), in the unified form of one rule per run.
// Differences: the bends of one-texel channels let light into their open corner only; texels that all four neighbours
// contradict are turned beforehand instead of being skipped by walks; a corner's run that does not count is ignored.
// See docs/techniques/rsmss.md. How to include: as revectorisation_lib.glsl; codes are looked at with kHealed:
//     uint code = look_at(texel, kAllSides, kHealed);
//     rsmss_visibility(code, texel, place, limit, kChannelsPaper or kChannelsDisjoint)     0..1

#include "lib/revectorisation_lib.glsl"

const int kChannelsPaper = 0;     // one run for both sides of a channel, and the paper's cases
const int kChannelsDisjoint = 1;  // each side's own run, and their coverages added

float unit(float value) { return clamp(value, 0.0, 1.0); }

// Coverage of the lit side for a sample `depth` away from its side, on a run that has come as far as `done`.
float ramp(bool lit, float depth, float done) { return lit ? unit(1.0 + depth - done) : unit(done - depth); }

// A channel as the cases are written: two sides across, a run along. `low` is towards smaller coordinates.
struct Channel {
    uint both, low, high;  // sides across
    uint ahead, back;      // sides along, towards larger and smaller coordinates
    ivec2 along;
    vec2 place;  // x: from the low side; y: along
};

Channel make_channel(uint sides, vec2 place) {
    if (has_all(sides, kSidesX))
        return Channel(kSidesX, kLeft, kRight, kBottom, kTop, ivec2(0, 1), place);
    return Channel(kSidesY, kTop, kBottom, kRight, kLeft, ivec2(1, 0), place.yx);
}

// What lies along a channel: the sides that its neighbours keep, ahead and back, and those that the first texel keeps
// that has lost one (0: both, or an end came first).
struct Surroundings {
    uint ahead, back, kept;
};

Surroundings look_along(Channel channel, uint third, ivec2 texel, bool lit, int limit) {
    Surroundings around = Surroundings(0u, 0u, 0u);
    int nearest = limit + 1;
    for (int k = 0; k < 2; ++k) {
        ivec2 along = k == 0 ? channel.along : -channel.along;
        int reach = third == (k == 0 ? channel.ahead : channel.back) ? 0 : limit;
        uint code = channel.both | (lit ? kLitTexel : 0u);
        int n = 0;
        while (n < reach && has_all(code, channel.both) && has_any(code, kLitTexel) == lit) {
            code = look_at(texel + ++n * along, channel.both, kHealed);
            if (n == 1 && k == 0) around.ahead = code & channel.both;
            if (n == 1 && k == 1) around.back = code & channel.both;
        }
        bool broken = has_any(code, kLitTexel) == lit && !has_all(code, channel.both);
        if (broken && n < nearest) {
            nearest = n;
            around.kept = code & channel.both;
        }
    }
    return around;
}

// Light that reaches round a bend: only into the corner that is open to it. `towards`: from the far end to the bend.
float bend(uint kept, Channel channel, float towards) {
    float across = kept == channel.low ? channel.place.x : 1.0 - channel.place.x;
    return kept == channel.low || kept == channel.high ? unit(across + towards - 1.0) : 0.0;
}

// Lit, one end closed (cases 8-11) or both (4-7). `third`: the side along that is shadowed too, or 0.
float lit_channel(Channel channel, uint third, Surroundings around, Run run) {
    float x = channel.place.x, y = channel.place.y;
    float third_depth = third == 0u ? 1.0 : third == channel.ahead ? 1.0 - y : y;
    if (run.closed && third != 0u) {
        uint onwards = third == channel.ahead ? around.back : around.ahead;
        float done = run.nearest + 0.5;
        return onwards == channel.both ? min(third_depth, min(unit(1.0 + x - done), unit(2.0 - x - done)))
                                       : bend(onwards, channel, third_depth);
    }
    if (run.closed) return max(bend(around.ahead, channel, y), bend(around.back, channel, 1.0 - y));
    if (around.kept == channel.low) return min(third_depth, unit(1.0 + x - run.done));
    if (around.kept == channel.high) return min(third_depth, unit(2.0 - x - run.done));
    return 1.0 - run.done;
}

// Shadowed between two lit sides (cases 12-15).
float dark_channel(Channel channel, uint third, Surroundings around, Run run) {
    float x = channel.place.x;
    float over_low = unit(run.done - x), over_high = unit(run.done + x - 1.0);
    if (third == 0u)
        return around.kept == channel.low ? over_low : around.kept == channel.high ? over_high : run.done;
    float over_third = third == channel.ahead ? channel.place.y : 1.0 - channel.place.y;
    uint opposite = third == channel.ahead ? around.back : around.ahead;
    if (opposite == channel.low) return max(over_third, over_low);
    if (opposite == channel.high) return max(over_third, over_high);
    if (opposite == 0u || around.kept == 0u) return run.done;
    return max(over_third, around.kept == channel.low ? 1.0 - x : x);
}

float channel_by_cases(uint code, ivec2 texel, vec2 place, int limit, Run run) {
    bool lit = has_any(code, kLitTexel);
    Channel channel = make_channel(code, place);
    uint third = code & (channel.back | channel.ahead);
    Surroundings around = look_along(channel, third, texel, lit, run.open ? 0 : limit);
    if (run.open) return lit ? 1.0 : 0.0;
    return lit ? lit_channel(channel, third, around, run) : dark_channel(channel, third, around, run);
}

// The runs to follow: none, one, or two that are combined.
uvec2 choose_runs(uint sides, ivec2 texel, int channels) {
    uint across_y = sides & kSidesY, across_x = sides & kSidesX;
    if (is_channel(sides)) {
        uint both = has_all(sides, kSidesX) ? kSidesX : kSidesY;
        return channels == kChannelsPaper ? uvec2(both, 0u) : uvec2(lowest(both), both & (both - 1u));
    }
    if (across_x == 0u || across_y == 0u) return uvec2(across_x | across_y, 0u);
    bvec2 counts = find_dominant(texel, sides, kHealed);
    return uvec2(counts.x ? across_y : across_x, counts.x && counts.y ? across_x : 0u);
}

// [Macedo16] 3.3: v_RSMSS.
float rsmss_visibility(uint code, ivec2 texel, vec2 place, int limit, int channels) {
    bool lit = has_any(code, kLitTexel);
    uint sides = code & kAllSides;
    float plain = lit ? 1.0 : 0.0;
    if (sides == kAllSides) return 1.0 - plain;
    uvec2 runs = choose_runs(sides, texel, channels);
    vec2 parts = vec2(plain);
    Run run;
    int count = runs.x == 0u ? 0 : runs.y == 0u ? 1 : 2;
    for (int k = 0; k < count; ++k) {
        uint side = k == 0 ? runs.x : runs.y;
        run = follow_run(texel, side, lit, kHealed, place, limit);
        float part = ramp(lit, side_depth(side, place), run.done);
        parts = k == 0 ? vec2(part, plain) : vec2(parts.x, part);
    }
    // The coverages of a channel's two walls don't overlap: what both leave over is lit.
    if (is_channel(sides)) parts = vec2(unit(lit ? parts.x + parts.y - 1.0 : parts.x + parts.y));
    for (int k = is_channel(sides) && channels == kChannelsPaper ? 0 : 1; k < 1; ++k)
        parts = vec2(channel_by_cases(code, texel, place, limit, run));
    return lit ? min(parts.x, parts.y) : max(parts.x, parts.y);
}
