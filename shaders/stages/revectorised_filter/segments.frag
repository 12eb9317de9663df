// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Second of two programs, equal to taps.frag and far cheaper: the tests of the kernel and its rim are packed into rows
// and columns of bits, in which the sides, corners, channels and runs of all taps are found at once. A run of texels with
// the same side is evaluated as a whole, and walked only where it leaves the rim. Kernels that are too wide for a line of
// bits are cut into tiles.
// Defines: those of inputs.glsl; TILE (texels per side of a tile, at most 27), TILES (per side of the kernel), TAP_BITS
// (which texels of a tile's line are taps).
#include "stages/revectorised_filter/lines.glsl"
#include "stages/revectorised_filter/tap.glsl"

layout(location = 0) out float visibility;

// (texels - distance) / texels > depth, rounded as make_run of the library does it.
bool has_passed(float texels, float distance, float depth) { return (texels - distance) / texels > depth; }

// Most steps at which the run has come farther than `depth`, the distance being steps + `shift`.
int count_passed(float texels, float depth, float shift) {
    float guess = floor(texels * (1.0 - depth) - shift);
    bool next = has_passed(texels, guess + 1.0 + shift, depth), own = has_passed(texels, guess + shift, depth);
    return int(guess) + (next ? 1 : own ? 0 : -1);
}

// A run: texels low..high of a line, as far as is known and needed.
struct Segment {
    int low, high;
    bool closed_low, closed_high;
};

// Sum over the bits of 1 - distance / texels - depth. Distances are steps - at from the higher end, steps - 1 + at from
// the lower.
float sum_ramp(Segment segment, uint bits, bool from_high, float texels, float depth, float at) {
    float count = float(bitCount(bits)), places = float(sum_of_places(bits));
    float distances =
        from_high ? count * (float(segment.high + 1) - at) - places : places - count * (float(segment.low) - at);
    return count * (1.0 - depth) - distances / texels;
}

// Gain of the texels `wanted` of a segment. `at`: the sample's place along the line. Without branches and loops: of a
// loop within a loop, a software rasteriser works the body once even where it has no trips.
float evaluate(Segment segment, uint wanted, float depth, float at) {
    int length = max(segment.high - segment.low + 1, 1);
    float texels = float(min(length, u_walk_limit));
    uint near_high = segment.closed_high ? wanted & bits_between(segment.high - u_walk_limit + 1, segment.high) : 0u;
    uint near_low = segment.closed_low ? wanted & bits_between(segment.low, segment.low + u_walk_limit - 1) : 0u;
    // Between two ends within the walk limit a run is done.
    uint closed = near_high & near_low;
    int to_high = count_passed(texels, depth, -at), to_low = count_passed(texels, depth, at) + 1;
    uint from_high = near_high & ~closed & bits_between(segment.high - to_high + 1, segment.high);
    uint from_low = near_low & ~closed & bits_between(segment.low, segment.low + to_low - 1);
#if SMOOTH
    return sum_ramp(segment, from_high, true, texels, depth, at) + sum_ramp(segment, from_low, false, texels, depth, at) +
           float(bitCount(closed)) * (1.0 - depth);
#else
    return float(bitCount(from_high | from_low | (depth < 1.0 ? closed : 0u)));
#endif
}

// Steps to where a run ends (> 0) or begins (< 0), as walk of the library; of texels as tested it needs no healing.
int walk_on(ivec2 texel, ivec2 along, uint side, bool lit) {
#if SMOOTH
    return walk(texel, along, side, lit, kHealing, u_walk_limit - 1);
#else
    ivec2 across = step_over(side);
    bool on = true, same = true;
    int steps = 0;
    while (on && steps < u_walk_limit - 1) {
        texel += along;
        ++steps;
        same = is_texel_lit(texel) == lit;
        on = same && is_texel_lit(texel + across) != lit;
    }
    return on ? -u_walk_limit : same ? -steps : steps;
#endif
}

// The run of `open` texels that begins at `first`, as far as the line shows it.
Segment read_segment(uint own, uint open, uint first) {
    uint after = bit_after_run(open, first);
    return Segment(place_of(first), place_of(after) - 1, (own & (first >> 1)) == 0u, (own & after) == 0u);
}

// Walks where it leaves the rim.
void complete_segment(inout Segment segment, int direction, int index, ivec2 first) {
    bool is_row = (direction & 2) == 0, towards_next = (direction & 1) != 0;
    ivec2 along = is_row ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 origin = first - 1 + index * along.yx;
    uint side = is_row ? (towards_next ? kBottom : kTop) : (towards_next ? kRight : kLeft);
    for (int end = segment.low == 0 ? 0 : 1; end < (segment.high == kSide - 1 ? 2 : 1); ++end) {
        bool up = end == 1;
        int found = walk_on(origin + (up ? kSide - 1 : 0) * along, up ? along : -along, side, direction < 4);
        segment.closed_low = up ? segment.closed_low : found > 0;
        segment.closed_high = up ? found > 0 : segment.closed_high;
        segment.low = up ? segment.low : 1 - abs(found);
        segment.high = up ? TILE + abs(found) : segment.high;
    }
}

// The sample's depth below the side of a direction (x) and its place along the lines (y).
vec2 place_in(int direction) {
    vec2 place = (direction & 2) == 0 ? kernel.place : kernel.place.yx;
    return vec2((direction & 1) != 0 ? 1.0 - place.y : place.y, place.x);
}

// Runs of a line that reach one of its ends.
uint runs_at_ends(uint open) {
    uint below = ~open & kLineBits;  // up to the highest bit that is not open
    below |= below >> 1;
    below |= below >> 2;
    below |= below >> 4;
    below |= below >> 8;
    below |= below >> 16;
    return (open & ~below) | ((open & 1u) != 0u ? run_from(open, 1u) : 0u);
}

// Gains of all runs that stay within the rim, or of those that leave it. One loop over all directions and lines, so that
// the lanes of a processor find something to do at each of its trips.
float follow_runs(uint lines_of[2 * kGroups], bool leaving, ivec2 first_texel) {
    float sum = 0.0;
    uint directions = 0u, lines = 0u, left = 0u, own = 0u, open = 0u, taps = 0u;
    int direction = 0, index = 0;
    for (int k = 0; k < 2 * kGroups; ++k) directions |= lines_of[k] != 0u ? 1u << k : 0u;
    while ((directions | lines | left) != 0u) {
        if (left == 0u) {
            if (lines == 0u) {
                uint direction_bit = lowest_bit(directions);
                direction = place_of(direction_bit);
                directions ^= direction_bit;
                lines = lines_of[direction];
            }
            uint line_bit = lowest_bit(lines);
            lines ^= line_bit;
            index = place_of(line_bit);
            own = line_at(direction >> 1, index);
            uint all = own & ~line_at(direction >> 1, index + ((direction & 1) != 0 ? 1 : -1));
            taps = g_taps[(direction >> 1) * kSide + index];
            open = all & (taps | longer_than_one(all));
            uint at_ends = runs_at_ends(open);
            left = leaving ? at_ends : open & ~at_ends;
        }
        uint first = lowest_bit(left), run = run_from(left, first);
        left ^= run;
        Segment segment = read_segment(own, open, first);
        if (leaving) complete_segment(segment, direction, index, first_texel);
        vec2 place = place_in(direction);
        float gain = evaluate(segment, run & taps, place.x, place.y);
        sum += direction < 4 ? -gain : gain;
    }
    return sum;
}

// Goes over the bits of a tile's lines, one after the other.
struct Cursor {
    uint lines, left;  // lines to come, bits of the present one to come
    int index;         // the present line
};

// Gain of a corner by its run along a line.
float evaluate_corner(int group, int index, uint texel, ivec2 first_texel) {
    uint own = line_at(group, index), next = line_at(group, index + 1);
    bool towards_next = (texel & ~next) != 0u;
    uint open = own & ~(towards_next ? next : line_at(group, index - 1));
    uint before = ~open & (texel - 1u);
    Segment segment = read_segment(own, open, before == 0u ? 1u : bit_at(findMSB(before) + 1));
    int direction = 2 * group + (towards_next ? 1 : 0);
    complete_segment(segment, direction, index, first_texel);
    vec2 place = place_in(direction);
    return evaluate(segment, texel, place.x, place.y);
}

// Corners both of whose runs count: the greater gain.
float evaluate_both(int field, ivec2 first_texel) {
    Cursor cursor = Cursor(0u, 0u, 0);
    for (int k = 1; k <= TILE; ++k) cursor.lines |= g_both[field * kSide + k] != 0u ? 1u << k : 0u;
    float sum = 0.0;
    while ((cursor.lines | cursor.left) != 0u) {
        if (cursor.left == 0u) {
            uint line_bit = lowest_bit(cursor.lines);
            cursor.lines ^= line_bit;
            cursor.index = place_of(line_bit);
            cursor.left = g_both[field * kSide + cursor.index];
        }
        uint texel = lowest_bit(cursor.left);
        cursor.left ^= texel;
        float gain = 0.0;
        for (int axis = 0; axis < 2; ++axis)
            gain = max(gain, evaluate_corner(2 * field + axis, axis == 0 ? cursor.index : place_of(texel),
                                             axis == 0 ? texel : bit_at(cursor.index), first_texel));
        sum += field == 0 ? -gain : gain;
    }
    return sum;
}

#if SMOOTH
// Channels are left to the library.
float evaluate_channels(ivec2 first_texel) {
    Cursor cursor = Cursor(0u, 0u, 0);
    for (int k = 1; k <= TILE; ++k) cursor.lines |= g_channels[k] != 0u ? 1u << k : 0u;
    float sum = 0.0;
    while ((cursor.lines | cursor.left) != 0u) {
        if (cursor.left == 0u) {
            uint line_bit = lowest_bit(cursor.lines);
            cursor.lines ^= line_bit;
            cursor.index = place_of(line_bit);
            cursor.left = g_channels[cursor.index];
        }
        uint texel = lowest_bit(cursor.left);
        cursor.left ^= texel;
        bool lit = (g_lines[cursor.index] & texel) != 0u;
        sum += evaluate_tap(first_texel + ivec2(place_of(texel), cursor.index) - 1) - (lit ? 1.0 : 0.0);
    }
    return sum;
}
#endif

// Visibilities of a tile's taps, summed up. `taps`: its columns and rows that have taps.
float sum_tile(ivec2 first, uvec2 taps) {
    fetch_lines(first);
    int lit_count = 0;
    uint bit = 2u;
    for (int k = 1; k <= TILE; ++k, bit += bit) lit_count += (taps.y & bit) != 0u ? bitCount(g_lines[k] & taps.x) : 0;
    float sum = float(lit_count);
    for (int group = 0; group < kGroups; ++group) {
        float gain = sort_taps(group, (group & 1) == 0 ? taps.xy : taps.yx);
        sum += group < 2 ? -gain : gain;
    }
    sum += follow_runs(g_pending, false, first) + follow_runs(g_leaving, true, first);
    for (int field = 0; field < kGroups / 2; ++field) sum += evaluate_both(field, first);
#if SMOOTH
    sum += evaluate_channels(first);
#endif
    return sum;
}

// Every SPACING-th texel of a tile that is `start` texels from the first tap; tiles are multiples of SPACING apart.
uint tap_bits(int start) { return (TAP_BITS << 1) & bits_between(1, 1 + kExtent - start); }

void main() {
    fetch_kernel(ivec2(gl_FragCoord.xy));
    float sum = 0.0;
    for (int k = 0; k < TILES * TILES; ++k) {
        ivec2 start = TILE * ivec2(k % TILES, k / TILES);
        sum += sum_tile(kernel.first + start, uvec2(tap_bits(start.x), tap_bits(start.y)));
    }
    float count = float(KERNEL * KERNEL);
    visibility = combine_visibility(kernel.receiver, kernel.layer, sum == count ? 1.0 : clamp(sum / count, 0.0, 1.0));
}
