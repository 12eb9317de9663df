// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// No include guard needed: each tile_kernel_*.cpp includes this once, with `Arch` defined in an anonymous namespace.
//
// All four conditions of a hit (three edges, depth) are divided by the bound of their own float error. Then one minimum
// answers: above 1 the triangle shadows the receiver, below -1 it does not, and between the pair is left open.
#include <xsimd/xsimd.hpp>

#include "stages/tile_kernel.h"

namespace shadow_layers::tile_kernel {
namespace {

using Lanes = xsimd::batch<float, Arch>;
constexpr std::uint32_t kLanes = std::uint32_t(Lanes::size);

// Roundings of a product and a sum of two floats each, with a reserve.
constexpr double kFloatError = 1.0 / 4194304.0;  // 2^-22
// Hits this near to the plane are settled in double too, where the receiver's flat neighbours are known.
constexpr double kContact = 1e-5;

inline double magnitude(double value) { return value < 0 ? -value : value; }

/// The triangle about one tile: conditions scaled by their errors.
struct TileForms {
    float at[4], by_x[4], by_y[4];
    float by_depth;
};

/// False if the triangle can't shadow any receiver of the tile.
inline bool make_forms(const CasterTriangle& t, const Tiles& tiles, double x, double y, std::size_t tile,
                       TileForms& forms) {
    const double place_error = tiles.place_error[tile], half = tiles.half_size;
    for (int i = 0; i < 3; ++i) {
        const LinearForm& edge = t.edges[i];
        const double at = edge.at_origin + x * edge.by_x + y * edge.by_y;
        const double slope = magnitude(edge.by_x) + magnitude(edge.by_y);
        const double error = kFloatError * (magnitude(at) + slope * half) + slope * place_error + t.edge_error[i];
        if (at + slope * half + error < 0) return false;
        const double scale = 1 / (error + 1e-300);
        forms.at[i] = float(at * scale);
        forms.by_x[i] = float(edge.by_x * scale);
        forms.by_y[i] = float(edge.by_y * scale);
    }
    const double at = t.depth.at_origin + x * t.depth.by_x + y * t.depth.by_y;
    const double slope = magnitude(t.depth.by_x) + magnitude(t.depth.by_y);
    const double error = kFloatError * (magnitude(at) + slope * half) + kContact * magnitude(at) + slope * place_error +
                         tiles.depth_error[tile] + t.depth_error;
    double nearest = at + slope * half;
    if (nearest > t.greatest_depth) nearest = t.greatest_depth;
    if (nearest + error < double(tiles.least_depth[tile])) return false;
    const double scale = 1 / (error + 1e-300);
    forms.at[3] = float(at * scale);
    forms.by_x[3] = float(t.depth.by_x * scale);
    forms.by_y[3] = float(t.depth.by_y * scale);
    forms.by_depth = float(-scale);
    return true;
}

inline void remove_receiver(Tiles& tiles, std::uint32_t first, std::uint32_t slot, std::uint32_t& count) {
    const std::uint32_t last = first + --count;
    tiles.x[slot] = tiles.x[last];
    tiles.y[slot] = tiles.y[last];
    tiles.depth[slot] = tiles.depth[last];
    tiles.pixel[slot] = tiles.pixel[last];
}

inline void note_open(Answers& answers, std::uint32_t pixel, const CasterTriangle& t) {
    if (answers.open_count == answers.open_capacity) answers.settle(answers.context, answers);
    answers.open[answers.open_count++] = {pixel, t.instance, t.triangle};
}

inline void test_tile(const CasterTriangle& t, const TileForms& f, std::size_t tile, Tiles& tiles, Answers& answers) {
    const std::uint32_t first = tiles.first[tile];
    std::uint32_t count = tiles.count[tile];
    answers.tests += count;
    // From the last block down: a removed receiver's place is taken by the tile's last one, which is tested already.
    for (std::uint32_t end = (count + kLanes - 1) / kLanes * kLanes; end > 0; end -= kLanes) {
        const std::uint32_t begin = end - kLanes;
        const Lanes x = Lanes::load_unaligned(tiles.x + first + begin);
        const Lanes y = Lanes::load_unaligned(tiles.y + first + begin);
        Lanes least = xsimd::fma(y, Lanes(f.by_y[3]), xsimd::fma(x, Lanes(f.by_x[3]), Lanes(f.at[3])));
        least = xsimd::fma(Lanes::load_unaligned(tiles.depth + first + begin), Lanes(f.by_depth), least);
        for (int i = 0; i < 3; ++i)
            least = xsimd::min(least, xsimd::fma(y, Lanes(f.by_y[i]), xsimd::fma(x, Lanes(f.by_x[i]), Lanes(f.at[i]))));
        if (!xsimd::any(least >= Lanes(-1.0f))) continue;
        float values[kLanes];
        least.store_unaligned(values);
        for (std::uint32_t lane = count - begin < kLanes ? count - begin : kLanes; lane-- > 0;) {
            if (!(values[lane] >= -1.0f)) continue;
            const std::uint32_t slot = first + begin + lane, pixel = tiles.pixel[slot];
            if (answers.ids[2 * std::size_t(pixel)] == t.instance &&
                answers.ids[2 * std::size_t(pixel) + 1] == t.triangle)
                continue;
            if (values[lane] > 1.0f) {
                answers.visible[pixel] = 0;
                remove_receiver(tiles, first, slot, count);
            } else {
                note_open(answers, pixel, t);
            }
        }
    }
    tiles.count[tile] = count;
}

inline void draw_triangle(const CasterTriangle& t, int row_begin, int row_end, Tiles& tiles, Answers& answers) {
    const int from = t.row_begin > row_begin ? t.row_begin : row_begin, to = t.row_end < row_end ? t.row_end : row_end;
    TileForms forms;
    for (int row = from; row < to; ++row) {
        const double y = (2 * row + 1) * tiles.half_size - 1;
        for (int column = t.column_begin; column < t.column_end; ++column) {
            const std::size_t tile = std::size_t(row) * std::size_t(tiles.side) + std::size_t(column);
            if (tiles.count[tile] == 0) continue;
            const double x = (2 * column + 1) * tiles.half_size - 1;
            if (make_forms(t, tiles, x, y, tile, forms)) test_tile(t, forms, tile, tiles, answers);
        }
    }
}

inline void draw_all(const CasterTriangle* triangles, const std::uint32_t* order, std::size_t count, int row_begin,
                     int row_end, Tiles& tiles, Answers& answers) {
    for (std::size_t i = 0; i < count; ++i) draw_triangle(triangles[order[i]], row_begin, row_end, tiles, answers);
}

}  // namespace
}  // namespace shadow_layers::tile_kernel
