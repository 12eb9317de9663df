// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A part of facet_kernel.cpp.
//
// A caster's edges and plane are half-planes of the light's clip space. Over a facet x, y, z and w are linear, so they
// are half-planes of the pixel's square, too, without a division: what [Pan09] 3.4 does by projecting two points of
// each line. Those that cut the square become masks of samples.
#include "base/kernel_arch.h"
#include "techniques/fsasm/facet_kernel.h"

namespace shadow_layers::facet_kernel {
namespace {

using Lanes = xsimd::batch<float, Arch>;
constexpr int kLanes = int(Lanes::size);

// Bits are gathered as a sum of powers of two, 16 at a time: float holds it exactly.
constexpr int kBitsAtOnce = 16;
constexpr float kBits[kBitsAtOnce] = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768};
static_assert(kLanes <= kBitsAtOnce);

// Roundings of two products and two sums in float of parts of 1, with a reserve.
constexpr double kFloatError = 1.0 / 2097152.0;  // 2^-21
inline double magnitude(double value) { return value < 0 ? -value : value; }

/// False if the triangle shadows no place of the square.
inline bool make_conditions(const CasterTriangle& t, const LightFacet& f, Conditions& c) {
    constexpr double is_depth[4] = {0, 0, 0, 1};  // the receiver's own depth counts against the plane's
    double most[4];
    for (int i = 0; i < 4; ++i) {
        c.at[i] = t.at[i] * f.at[3] + t.by_x[i] * f.at[0] + t.by_y[i] * f.at[1] - is_depth[i] * f.at[2];
        c.by_x[i] = t.at[i] * f.by_x[3] + t.by_x[i] * f.by_x[0] + t.by_y[i] * f.by_x[1] - is_depth[i] * f.by_x[2];
        c.by_y[i] = t.at[i] * f.by_y[3] + t.by_x[i] * f.by_y[0] + t.by_y[i] * f.by_y[1] - is_depth[i] * f.by_y[2];
        c.error[i] = t.error[i] * f.extent + is_depth[i] * (1e-14 * f.depth_extent);
        c.half_range[i] = 0.5 * (magnitude(c.by_x[i]) + magnitude(c.by_y[i]));
        most[i] = c.at[i] + c.half_range[i] + c.error[i];
    }
    return most[0] >= 0 && most[1] >= 0 && most[2] >= 0 && most[3] >= 0;
}

/// Samples that float can't tell, in double.
inline void decide_open(const Samples& s, double at, double by_x, double by_y, std::uint32_t open, int first,
                        std::uint32_t& inside) {
    for (; open; open &= open - 1) {
        const int bit = __builtin_ctz(open), i = first + bit;
        if (at + by_x * double(s.x[i]) + by_y * double(s.y[i]) >= 0) inside |= 1u << bit;
    }
}

inline void cut_half_plane(const Samples& s, double at, double by_x, double by_y, double error,
                           std::uint32_t (&mask)[kWords]) {
    if (s.table) {
        s.look_up(s.table, at, by_x, by_y, mask);
        return;
    }
    const double size = magnitude(at) + magnitude(by_x) + magnitude(by_y);
    const double scale = size > 0 ? 1 / size : 0;
    const Lanes base(float(at * scale)), x_step(float(by_x * scale)), y_step(float(by_y * scale));
    const float bound = float(kFloatError + error * scale);
    for (int first = 0; first < s.count; first += 32) {
        std::uint32_t inside = 0, open = 0;
        for (int part = 0; part < 32 && first + part < s.count; part += kBitsAtOnce) {
            Lanes sure_bits(0.0f), open_bits(0.0f);
            for (int bit = 0; bit < kBitsAtOnce && first + part + bit < s.count; bit += kLanes) {
                const Lanes x = Lanes::load_unaligned(s.x + first + part + bit);
                const Lanes y = Lanes::load_unaligned(s.y + first + part + bit);
                const Lanes value = xsimd::fma(y, y_step, xsimd::fma(x, x_step, base));
                const Lanes bits = Lanes::load_unaligned(kBits + bit), none(0.0f);
                sure_bits += xsimd::select(value > Lanes(bound), bits, none);
                open_bits += xsimd::select(xsimd::abs(value) <= Lanes(bound), bits, none);
            }
            inside |= std::uint32_t(xsimd::hadd(sure_bits)) << part;
            open |= std::uint32_t(xsimd::hadd(open_bits)) << part;
        }
        if (open) decide_open(s, at, by_x, by_y, open, first, inside);
        mask[first / 32] &= inside;
    }
}

inline bool is_dark(const LightFacet& f, const FacetPair& pair) {
    std::uint32_t lit = 0;
    for (int word = 0; word < kWords; ++word) lit |= f.in_view[word] & ~pair.occluded[word];
    return lit == 0;
}

inline void test_pair(const CasterTriangle& t, const LightFacet& f, const Samples& s, FacetPair& pair,
                      Answers& answers) {
    if (f.instance == t.instance && f.triangle == t.triangle) return;
    // Where other views or the cone have a say, too, the validity mask weighs them, so that it is made whole.
    if (f.is_alone && is_dark(f, pair)) return;
    ++answers.evaluations;
    Conditions c;
    if (!make_conditions(t, f, c)) return;
    const bool is_near = c.at[3] - c.half_range[3] - c.error[3] <= f.near;
    // Not a touch above the facet: as at a convex edge.
    if (is_near && c.at[3] + c.half_range[3] <= c.error[3]) return;
    std::uint32_t mask[kWords] = {f.in_view[0], f.in_view[1], f.in_view[2], f.in_view[3]};
    for (int i = 0; i < 4; ++i)
        if (c.at[i] - c.half_range[i] - c.error[i] < 0)
            cut_half_plane(s, c.at[i], c.by_x[i], c.by_y[i], c.error[i], mask);
    if (is_near) {
        ++answers.contacts;
        answers.settle(answers.context, t, f, c, mask, pair);
        return;
    }
    for (int word = 0; word < kWords; ++word) pair.occluded[word] |= mask[word];
}

/// Does the triangle touch the texel about (x, y)?
inline bool may_touch(const CasterTriangle& t, double x, double y, double half) {
    for (int i = 0; i < 3; ++i) {
        const double half_range = half * (1 + 1e-6) * (magnitude(t.by_x[i]) + magnitude(t.by_y[i]));
        if (t.at[i] + x * t.by_x[i] + y * t.by_y[i] + half_range + t.error[i] < 0) return false;
    }
    return true;
}

inline void draw_triangle(const CasterTriangle& t, int row_begin, int row_end, const PairTexels& texels,
                          const Samples& samples, Answers& answers) {
    const tile_kernel::TileExtent& extent = t.extent;
    const int from = extent.row_begin > row_begin ? extent.row_begin : row_begin;
    const int to = extent.row_end < row_end ? extent.row_end : row_end;
    for (int row = from; row < to; ++row) {
        const double y = (2 * row + 1) * texels.half_size - 1;
        for (int column = extent.column_begin; column < extent.column_end; ++column) {
            const tile_kernel::TileContent& texel =
                texels.texels[std::size_t(row) * std::size_t(texels.side) + std::size_t(column)];
            if (texel.count == 0 || double(texel.least_depth) > extent.greatest_depth) continue;
            const double x = (2 * column + 1) * texels.half_size - 1;
            if (!may_touch(t, x, y, texels.half_size)) continue;
            ++answers.texel_pairs;
            FacetPair* pairs = texels.pairs + texel.first;
            for (std::uint32_t i = 0; i < texel.count; ++i)
                test_pair(t, texels.facets[pairs[i].light_facet], samples, pairs[i], answers);
        }
    }
}

inline void draw_all(const CasterTriangle* triangles, const std::uint32_t* order, std::size_t count, int row_begin,
                     int row_end, const PairTexels& texels, const Samples& samples, Answers& answers) {
    for (std::size_t i = 0; i < count; ++i)
        draw_triangle(triangles[order[i]], row_begin, row_end, texels, samples, answers);
}

}  // namespace
}  // namespace shadow_layers::facet_kernel
