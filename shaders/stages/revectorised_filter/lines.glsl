// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The tests of a tile of taps as rows and columns of bits, and what they say of all its texels at once.
// Defines: those of inputs.glsl; TILE.
//
// "Line": a row or a column; "along" it lies a run, "across" it the side that carries the run. `p` and `n` are the
// sides towards the previous and the next line. The revectorised share of a texel's visibility is called its gain: the
// shadow that a lit texel gets, or the light that a shadowed one does.
#include "stages/revectorised_filter/inputs.glsl"
#include "lib/bit_line_lib.glsl"

const int kSide = TILE + 2;  // lines of a tile and a rim of one texel; its texels are bits and lines 1 to TILE
const uint kLineBits = (1u << kSide) - 1u;

const uint kEndBits = 1u | (1u << (kSide - 1));
const int kGroups = SMOOTH != 0 ? 4 : 2;  // rows and columns of the lit texels, then of those in shadow

uint g_lines[2 * kSide];               // of lit texels: rows, then columns
uint g_taps[kGroups * kSide];          // by group and line: taps that follow their run
uint g_pending[2 * kGroups];           // by direction, twice the group and 1 for sides towards the next line: lines
uint g_leaving[2 * kGroups];           // likewise, lines with runs that may leave the rim
uint g_both[kGroups / 2 * kSide];      // by field and row: corners that are taps and both of whose runs count
uint g_channels[kSide];                // by row: taps that are channels; SMOOTH only

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

// Texels of a group's field in one of its lines.
uint line_at(int group, int index) {
    return g_lines[index + ((group & 1) != 0 ? kSide : 0)] ^ (group >= 2 ? kLineBits : 0u);
}

// Which runs are to be followed, and gains that need none. A corner whose run along the line does not count has a run
// of a single texel there, which cannot be closed: it needs no look. `taps`: bits of a line, and lines that have taps.
float sort_taps(int group, uvec2 taps) {
    float sum = 0.0;
    bool is_row = (group & 1) == 0;
    uvec4 pending = uvec4(0u);
    uint previous, own = line_at(group, 0), next = line_at(group, 1), bit = 2u;
    for (int k = 1; k <= TILE; ++k, bit += bit) {
        previous = own, own = next, next = line_at(group, k + 1);
        Line line = read_line(previous, own, next, is_row);
        uint wanted = (taps.y & bit) != 0u ? taps.x : 0u;
        uint followed = wanted & ~line.channels & ~line.both & (line.counts | ~line.corners);
        g_taps[group * kSide + k] = followed;
        if (is_row) {
            g_both[group / 2 * kSide + k] = wanted & line.both;
#if SMOOTH
            g_channels[k] = (group == 0 ? 0u : g_channels[k]) | (wanted & line.channels);
#else
            sum += float(bitCount(line.channels & wanted));
#endif
        }
        bvec2 some = bvec2((line.p & followed) != 0u, (line.n & followed) != 0u);
        pending |= uvec4(some.x ? bit : 0u, some.y ? bit : 0u, some.x && (line.p & kEndBits) != 0u ? bit : 0u,
                         some.y && (line.n & kEndBits) != 0u ? bit : 0u);
    }
    g_pending[2 * group] = pending.x;
    g_pending[2 * group + 1] = pending.y;
    g_leaving[2 * group] = pending.z;
    g_leaving[2 * group + 1] = pending.w;
    return sum;
}
