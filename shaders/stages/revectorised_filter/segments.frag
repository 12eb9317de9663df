// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Second of two programs, equal to taps.frag and far cheaper: the tests of the kernel and its rim are packed into rows
// and columns of bits, in which the sides, corners, channels and runs of all taps are found at once. A run of texels with
// the same side is evaluated as a whole, and walked only where it leaves the rim. Kernels that are too wide for a line of
// bits are cut into tiles.
// Defines: those of inputs.glsl; TILE (texels per side of a tile, at most 27), TILES (per side of the kernel), TAP_BITS
// (which texels of a tile's line are taps).
//
// "Line": a row or a column; "along" it lies a run, "across" it the side that carries the run. `p` and `n` are the
// sides towards the previous and the next line. The revectorised share of a texel's visibility is called its gain: the
// shadow that a lit texel gets, or the light that a shadowed one does.
#include "stages/revectorised_filter/tap.glsl"
#include "lib/bit_line_lib.glsl"

layout(location = 0) out float visibility;

const int kSide = TILE + 2;  // lines of a tile and a rim of one texel; its texels are bits and lines 1 to TILE
const uint kLineBits = (1u << kSide) - 1u;

uint g_lines[2 * kSide];  // of lit texels: rows, then columns
uint g_taps[kSide];       // of the lines at work: taps that follow their run
uint g_both[kSide];       // likewise: corners that are taps and both of whose runs count
uint g_counted[kSide];    // by row: such corners that have gained along their row; not SMOOTH
uint g_channels[kSide];   // by row: taps that are channels; SMOOTH only

#if SMOOTH
// Turns texels that all four neighbours contradict; of lines with a rim of two.
void heal_lines(uint raw[TILE + 4], int base) {
    for (int k = 0; k < kSide; ++k) {
        uint own = raw[k + 1];
        uint alone = (own ^ raw[k]) & (own ^ raw[k + 2]) & (own ^ (own << 1)) & (own ^ (own >> 1));
        g_lines[base + k] = ((own ^ alone) >> 1) & kLineBits;
    }
}
#endif

void fetch_lines(ivec2 first) {
    const int side = TILE + 2 * kRim;
    uint rows[side], columns[side];
    for (int k = 0; k < side; ++k) columns[k] = 0u;
    uint row_bit = 1u;
    for (int y = 0; y < side; ++y, row_bit += row_bit) {
        uint row = 0u;
        for (int x = 0; x < side; ++x) {
            bool lit = is_texel_lit(first + ivec2(x, y) - kRim);
            row |= lit ? 1u << x : 0u;
            columns[x] |= lit ? row_bit : 0u;
        }
        rows[y] = row;
    }
#if SMOOTH
    heal_lines(rows, 0);
    heal_lines(columns, kSide);
#else
    for (int k = 0; k < kSide; ++k) {
        g_lines[k] = rows[k];
        g_lines[kSide + k] = columns[k];
    }
#endif
}

// What the bits of one line are.
struct Line {
    uint p, n;      // with an open side across
    uint channels, corners;
    uint counts;    // corners whose run along this line counts
    uint both;      // corners both of whose runs count
};

uint sides_along(uint own) { return own & (~(own << 1) | ~(own >> 1)); }

Line read_line(uint previous, uint own, uint next, bool is_row) {
    Line line;
    line.p = own & ~previous;
    line.n = own & ~next;
    uint low = own & ~(own << 1), high = own & ~(own >> 1), across = line.p | line.n;
    line.channels = (low & high) | (line.p & line.n);
    line.corners = (low | high) & across & ~line.channels;
    // find_dominant of the library, looking away from each side.
    uint on_along = (low & (across >> 1)) | (high & (across << 1));
    uint on_across = (line.p & sides_along(next)) | (line.n & sides_along(previous));
    line.both = line.corners & on_along & on_across;
    line.counts = line.corners & (is_row ? on_along | ~on_across : on_along);
    return line;
}

// (texels - way) / texels > depth, rounded as make_run of the library does it.
bool has_passed(float texels, float way, float depth) { return (texels - way) / texels > depth; }

// Most steps at which the run has come farther than `depth`, the way being steps + `shift`.
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

// Sum over the bits of 1 - way / texels - depth. Ways are steps - at from the higher end, steps - 1 + at from the lower.
float sum_ramp(Segment segment, uint bits, bool from_high, float texels, float depth, float at) {
    float count = float(bitCount(bits)), places = float(sum_of_places(bits));
    float ways = from_high ? count * (float(segment.high + 1) - at) - places : places - count * (float(segment.low) - at);
    return count * (1.0 - depth) - ways / texels;
}

// Gain of the texels `wanted` of a segment, of which `gained` have any. `at`: the sample's place along the line.
float evaluate(Segment segment, uint wanted, float depth, float at, out uint gained) {
    int length = segment.high - segment.low + 1;
    bool both = segment.closed_low && segment.closed_high, is_long = length > u_walk_limit;
    float texels = float(min(length, u_walk_limit)), sum = 0.0;
    // Where both ends are within the walk limit the run is done.
    uint closed = both && !is_long ? wanted : 0u, one_end = wanted & ~closed;
    uint near_high = segment.closed_high ? one_end : 0u, near_low = segment.closed_low ? one_end : 0u;
    for (int k = both && is_long ? 0 : 1; k < 1; ++k) {
        near_high &= bits_between(segment.high - u_walk_limit + 1, segment.high);
        near_low &= bits_between(segment.low, segment.low + u_walk_limit - 1);
        closed = near_high & near_low;
        near_high &= ~closed;
        near_low &= ~closed;
    }
    gained = depth < 1.0 ? closed : 0u;
    int left = (near_high != 0u ? 2 : 0) + (near_low != 0u ? 1 : 0);
    for (; left != 0; left = left > 2 ? left - 2 : 0) {
        bool up = left >= 2;
        int steps = min(count_passed(texels, depth, up ? -at : at) + (up ? 0 : 1), u_walk_limit);
        uint passed = up ? near_high & bits_between(segment.high - steps + 1, segment.high)
                         : near_low & bits_between(segment.low, segment.low + steps - 1);
        gained |= passed;
#if SMOOTH
        sum += sum_ramp(segment, passed, up, texels, depth, at);
#endif
    }
#if SMOOTH
    return sum + float(bitCount(closed)) * (1.0 - depth);
#else
    return float(bitCount(gained));
#endif
}

// One of the passes over a tile: the lit texels or those in shadow, by row or by column.
struct Field {
    bool is_row, lit;
    ivec2 first;       // texel of the tile
    uint taps, lines;  // bits of a line that are taps, and lines that have taps
};

// Texels of the field in one of its lines.
uint line_at(Field field, int index) {
    return g_lines[index + (field.is_row ? 0 : kSide)] ^ (field.lit ? 0u : kLineBits);
}

// Which runs are to be followed, and gains that need no run. A corner whose run along the line does not count has a run
// of a single texel there, which cannot be closed: it needs no look.
float sort_taps(Field field, out uvec2 pending) {
    float sum = 0.0;
    pending = uvec2(0u);
    uint previous, own = line_at(field, 0), next = line_at(field, 1), bit = 2u;
    for (int k = 1; k <= TILE; ++k, bit += bit) {
        previous = own, own = next, next = line_at(field, k + 1);
        Line line = read_line(previous, own, next, field.is_row);
        uint wanted = (field.lines & bit) != 0u ? field.taps : 0u;
        uint taps = wanted & ~line.channels & (line.counts | ~line.corners);
        g_both[k] = wanted & line.both;
#if SMOOTH
        taps &= ~line.both;
        g_channels[k] = wanted & line.channels;
#else
        sum += field.is_row ? float(bitCount(line.channels & wanted)) : 0.0;
        if (field.is_row) g_counted[k] = 0u;
#endif
        g_taps[k] = taps;
        pending |= uvec2((line.p & taps) != 0u ? bit : 0u, (line.n & taps) != 0u ? bit : 0u);
    }
    return sum;
}

// The run of `open` texels that begins at `first`; walked where it leaves the rim.
Segment find_segment(Field field, int index, uint own, uint open, uint first, bool towards_next) {
    uint after = bit_after_run(open, first);
    Segment segment = Segment(place_of(first), place_of(after) - 1, (own & (first >> 1)) == 0u, (own & after) == 0u);
    ivec2 along = field.is_row ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 origin = field.first - 1 + index * along.yx;
    uint side = field.is_row ? (towards_next ? kBottom : kTop) : (towards_next ? kRight : kLeft);
    for (int end = segment.low == 0 ? 0 : 1; end < (segment.high == kSide - 1 ? 2 : 1); ++end) {
        bool up = end == 1;
        int found = walk(origin + (up ? kSide - 1 : 0) * along, up ? along : -along, side, field.lit, kHealing,
                         u_walk_limit - 1);
        segment.closed_low = up ? segment.closed_low : found > 0;
        segment.closed_high = up ? found > 0 : segment.closed_high;
        segment.low = up ? segment.low : 1 - abs(found);
        segment.high = up ? TILE + abs(found) : segment.high;
    }
    return segment;
}

#if !SMOOTH
// Corners both of whose runs count gain once: how many of these have gained along their rows already?
float count_again(Field field, int index, uint corners) {
    float count = 0.0;
    for (uint left = corners; left != 0u;) {
        uint bit = lowest_bit(left);
        left ^= bit;
        if (field.is_row)
            g_counted[index] |= bit;
        else
            count += (g_counted[place_of(bit)] & bit_at(index)) != 0u ? 1.0 : 0.0;
    }
    return count;
}
#endif

// All runs whose side across is towards the previous or the next line; `lines`: those that have any. One loop, so that
// the lanes of a processor find something to do at each of its trips.
float follow_runs(Field field, bool towards_next, uint lines) {
    vec2 place = field.is_row ? kernel.place : kernel.place.yx;
    float depth = towards_next ? 1.0 - place.y : place.y, sum = 0.0;
    uint left = 0u, own = 0u, open = 0u, taps = 0u;
    int index = 0;
    while ((lines | left) != 0u) {
        if (left == 0u) {
            uint line_bit = lowest_bit(lines);
            index = place_of(line_bit);
            lines ^= line_bit;
            own = line_at(field, index);
            uint all = own & ~line_at(field, index + (towards_next ? 1 : -1));
            taps = g_taps[index];
            left = open = all & (taps | longer_than_one(all));
        }
        uint first = lowest_bit(left), run = run_from(left, first);
        left ^= run;
        uint gained;
        sum += evaluate(find_segment(field, index, own, open, first, towards_next), run & taps, depth, place.x, gained);
#if !SMOOTH
        sum -= count_again(field, index, gained & g_both[index]);
#endif
    }
    return sum;
}

#if SMOOTH
// Goes over the bits of a tile's lines, one after the other.
struct Cursor {
    uint lines, left;  // lines to come, bits of the present one to come
    int index;         // the present line
};

uint find_lines(uint bits_of[kSide]) {
    uint lines = 0u, bit = 2u;
    for (int k = 1; k <= TILE; ++k, bit += bit) lines |= bits_of[k] != 0u ? bit : 0u;
    return lines;
}

uint next_bit(inout Cursor cursor, uint bits_of[kSide]) {
    if (cursor.left == 0u) {
        uint line_bit = lowest_bit(cursor.lines);
        cursor.index = place_of(line_bit);
        cursor.lines ^= line_bit;
        cursor.left = bits_of[cursor.index];
    }
    uint bit = lowest_bit(cursor.left);
    cursor.left ^= bit;
    return bit;
}

// Gain of a corner by its run along a line.
float evaluate_corner(Field field, int index, uint texel) {
    uint own = line_at(field, index), next = line_at(field, index + 1);
    bool towards_next = (texel & ~next) != 0u;
    uint open = own & ~(towards_next ? next : line_at(field, index - 1));
    uint before = ~open & (texel - 1u);
    uint first = before == 0u ? 1u : bit_at(findMSB(before) + 1);
    vec2 place = field.is_row ? kernel.place : kernel.place.yx;
    uint gained;
    return evaluate(find_segment(field, index, own, open, first, towards_next), texel,
                    towards_next ? 1.0 - place.y : place.y, place.x, gained);
}

// Corners both of whose runs count: the greater gain.
float evaluate_both(Field field) {
    Cursor cursor = Cursor(find_lines(g_both), 0u, 0);
    float sum = 0.0;
    while ((cursor.lines | cursor.left) != 0u) {
        uint texel = next_bit(cursor, g_both);
        float gain = 0.0;
        for (int axis = 0; axis < 2; ++axis) {
            field.is_row = axis == 0;
            gain = max(gain, evaluate_corner(field, field.is_row ? cursor.index : place_of(texel),
                                             field.is_row ? texel : bit_at(cursor.index)));
        }
        sum += gain;
    }
    return sum;
}

// Channels are left to the library.
float evaluate_channels(Field field) {
    Cursor cursor = Cursor(find_lines(g_channels), 0u, 0);
    float sum = 0.0;
    while ((cursor.lines | cursor.left) != 0u) {
        uint texel = next_bit(cursor, g_channels);
        float v = evaluate_tap(field.first + ivec2(place_of(texel), cursor.index) - 1);
        sum += field.lit ? 1.0 - v : v;
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
    for (int pass = 0; pass < (SMOOTH != 0 ? 4 : 2); ++pass) {
        Field field = Field(pass % 2 == 0, pass < 2, first, pass % 2 == 0 ? taps.x : taps.y,
                            pass % 2 == 0 ? taps.y : taps.x);
        uvec2 pending;
        float gain = sort_taps(field, pending);
        for (int side = 0; side < 2; ++side) gain += follow_runs(field, side == 1, side == 1 ? pending.y : pending.x);
#if SMOOTH
        if (field.is_row) gain += evaluate_both(field) + evaluate_channels(field);
#endif
        sum += field.lit ? -gain : gain;
    }
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
