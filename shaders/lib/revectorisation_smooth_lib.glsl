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
    uint back, ahead;      // sides along, towards smaller and larger coordinates
    ivec2 along;
    vec2 place;  // x: from the low side; y: along
};

Channel make_channel(uint sides, vec2 place) {
    if (has_all(sides, kSidesX))
        return Channel(kSidesX, kLeft, kRight, kTop, kBottom, ivec2(0, 1), place);
    return Channel(kSidesY, kTop, kBottom, kLeft, kRight, ivec2(1, 0), place.yx);
}

// The first texel of a walk that has lost a side: how far away it is, and which sides it kept.
const int kNoBreak = 1 << 20;  // steps, where the run ends first
struct Break {
    int steps;
    uint kept;
};

Break find_break(ivec2 texel, ivec2 along, uint both, bool lit, int limit) {
    Break found = Break(kNoBreak, 0u);
    for (int n = 1; n <= limit; ++n) {
        uint code = look_at(texel + n * along, both, kHealed);
        bool is_end = has_any(code, kLitTexel) != lit;
        if (is_end || !has_all(code, both)) {
            if (!is_end) found = Break(n, code & both);
            break;
        }
    }
    return found;
}

// Light that reaches round a bend: only into the corner that is open to it. `across`: from the wall that goes on,
// `towards`: from the far end to the bend.
float bend(uint kept, Channel channel, float towards) {
    float across = kept == channel.low ? channel.place.x : 1.0 - channel.place.x;
    return has_any(kept, channel.both) ? unit(across + towards - 1.0) : 0.0;
}

// Lit, one end closed (cases 8-11) or, if `closed`, both (4-7). `third`: the side along that is shadowed too, or 0.
float lit_channel(Channel channel, uint third, ivec2 texel, Run run, int limit) {
    uint ahead = third == channel.ahead ? 0u : look_at(texel + channel.along, channel.both, kHealed);
    uint back = third == channel.back ? 0u : look_at(texel - channel.along, channel.both, kHealed);
    float third_depth = third == 0u ? 1.0 : third == channel.ahead ? 1.0 - channel.place.y : channel.place.y;
    float x = channel.place.x, y = channel.place.y;
    if (run.closed) {
        uint onwards = third == channel.ahead ? back : ahead;
        if (third != 0u) {
            float done = run.nearest + 0.5;
            float straight = min(third_depth, min(unit(1.0 + x - done), unit(2.0 - x - done)));
            return has_all(onwards, channel.both) ? straight : bend(onwards & channel.both, channel, third_depth);
        }
        float bend_ahead = has_all(ahead, channel.both) ? 0.0 : bend(ahead & channel.both, channel, y);
        float bend_back = has_all(back, channel.both) ? 0.0 : bend(back & channel.both, channel, 1.0 - y);
        return max(bend_ahead, bend_back);
    }
    Break before = find_break(texel, channel.along, channel.both, true, third == channel.ahead ? 0 : limit);
    Break behind = find_break(texel, -channel.along, channel.both, true, third == channel.back ? 0 : limit);
    uint kept = before.steps <= behind.steps ? before.kept : behind.kept;
    if (kept == channel.low) return min(third_depth, unit(1.0 + x - run.done));
    if (kept == channel.high) return min(third_depth, unit(2.0 - x - run.done));
    return 1.0 - run.done;
}

// Shadowed between two lit sides (cases 12-15).
float dark_channel(Channel channel, uint third, ivec2 texel, Run run, int limit) {
    float x = channel.place.x;
    float over_low = unit(run.done - x), over_high = unit(run.done + x - 1.0);
    Break before = find_break(texel, channel.along, channel.both, false, third == channel.ahead ? 0 : limit);
    Break behind = find_break(texel, -channel.along, channel.both, false, third == channel.back ? 0 : limit);
    uint kept = before.steps <= behind.steps ? before.kept : behind.kept;
    if (third == 0u) return kept == channel.low ? over_low : kept == channel.high ? over_high : run.done;
    float over_third = third == channel.ahead ? channel.place.y : 1.0 - channel.place.y;
    ivec2 opposite = texel + (third == channel.ahead ? -channel.along : channel.along);
    uint there = look_at(opposite, channel.both, kHealed) & channel.both;
    if (there == channel.low) return max(over_third, over_low);
    if (there == channel.high) return max(over_third, over_high);
    if (there == 0u || kept == 0u) return run.done;
    return max(over_third, kept == channel.low ? 1.0 - x : x);
}

float channel_by_cases(uint code, ivec2 texel, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    Channel channel = make_channel(code, place);
    Run run = follow_run(texel, channel.both, lit, kHealed, place, limit);
    if (run.open) return lit ? 1.0 : 0.0;
    uint third = code & (channel.back | channel.ahead);
    return lit ? lit_channel(channel, third, texel, run, limit) : dark_channel(channel, third, texel, run, limit);
}

// The two walls' coverages don't overlap: what both leave over is lit.
float channel_by_walls(uint code, ivec2 texel, vec2 place, int limit) {
    bool lit = has_any(code, kLitTexel);
    Channel channel = make_channel(code, place);
    Run low = follow_run(texel, channel.low, lit, kHealed, place, limit);
    Run high = follow_run(texel, channel.high, lit, kHealed, place, limit);
    float sum = ramp(lit, channel.place.x, low.done) + ramp(lit, 1.0 - channel.place.x, high.done);
    return unit(lit ? sum - 1.0 : sum);
}

// [Macedo16] 3.3: v_RSMSS.
float rsmss_visibility(uint code, ivec2 texel, vec2 place, int limit, int channels) {
    bool lit = has_any(code, kLitTexel);
    uint sides = code & kAllSides;
    float plain = lit ? 1.0 : 0.0;
    // Loops, because a software rasteriser skips one without trips, but no branch.
    bvec2 counts = bvec2(has_any(sides, kSidesY), has_any(sides, kSidesX));
    for (int k = is_corner(sides) ? 0 : 1; k < 1; ++k) counts = find_dominant(texel, sides, kHealed);
    uint side_of_x = counts.x && !is_channel(sides) ? sides & kSidesY : 0u;
    uint side_of_y = counts.y && !is_channel(sides) ? sides & kSidesX : 0u;
    uint first = side_of_x != 0u ? side_of_x : side_of_y;
    uint second = side_of_x != 0u ? side_of_y : 0u;
    Run first_run = follow_run(texel, first, lit, kHealed, place, limit);
    Run second_run = follow_run(texel, second, lit, kHealed, place, limit);
    float first_part = first != 0u ? ramp(lit, side_depth(first, place), first_run.done) : plain;
    float second_part = second != 0u ? ramp(lit, side_depth(second, place), second_run.done) : plain;
    float result = lit ? min(first_part, second_part) : max(first_part, second_part);
    if (has_all(sides, kAllSides)) return 1.0 - plain;
    for (int k = is_channel(sides) ? 0 : 1; k < 1; ++k)
        result = channels == kChannelsPaper ? channel_by_cases(code, texel, place, limit)
                                            : channel_by_walls(code, texel, place, limit);
    return result;
}
