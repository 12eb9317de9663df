// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A part of tile_kernel.cpp: triangles are drawn over tiles.
//
// All four conditions of a hit (three edges, depth) are divided by the bound of their own float error. Then one minimum
// answers: above 1 the triangle shadows the receiver, below -1 it does not, and between the pair is left open.
#include <sched.h>

#include "visibility/tile_kernel.h"
#include "visibility/tile_kernel_receivers.h"

namespace shadow_layers::tile_kernel {
namespace {

using Floats = xsimd::batch<float, Arch>;
using Words = xsimd::batch<std::int32_t, Arch>;
constexpr std::uint32_t kFloats = std::uint32_t(Floats::size);
constexpr int kParts = 4 / kDoubles;
static_assert(ReceiverBlock::kLanes % kFloats == 0 && 4 % kDoubles == 0);

// Roundings of a product and a sum of two floats each, with a reserve.
constexpr double kFloatError = 1.0 / 4194304.0;  // 2^-22
// Hits this near to the plane are settled in double too, where the receiver's flat neighbours are known.
constexpr double kContact = 1e-5;
// Rows of more columns than this are first narrowed to what the edges leave of them.
constexpr int kNarrow = 8;

constexpr double kHuge = 1.7976931348623157e308;
constexpr float kOutside = -2;

inline Words load_words(const std::uint32_t* values) {
    return Words::load_aligned(reinterpret_cast<const std::int32_t*>(values));
}

inline double magnitude(double value) { return value < 0 ? -value : value; }
inline double smaller(double a, double b) { return a < b ? a : b; }
inline double larger(double a, double b) { return a > b ? a : b; }

/// A triangle's forms with all that does not change from tile to tile.
struct CasterForms {
    Doubles at[kParts], by_x[kParts], by_y[kParts], slope[kParts];
    Doubles half_range[kParts];  ///< greatest change from a tile's middle
    Doubles constant[kParts];    ///< error that no tile changes
    Doubles relative[kParts];    ///< error by the form's magnitude
    Doubles is_depth[kParts];    ///< 1 for the depth
    Doubles most[kParts];        ///< that the form can be, whatever its plane says

    CasterForms(const CasterTriangle& t, double half_size) {
        const double relative_error[4] = {kFloatError, kFloatError, kFloatError, kFloatError + kContact};
        const double depth_only[4] = {0, 0, 0, 1}, greatest[4] = {kHuge, kHuge, kHuge, t.extent.greatest_depth};
        for (int p = 0; p < kParts; ++p) {
            const int i = p * kDoubles;
            at[p] = Doubles::load_unaligned(t.at + i);
            by_x[p] = Doubles::load_unaligned(t.by_x + i);
            by_y[p] = Doubles::load_unaligned(t.by_y + i);
            slope[p] = xsimd::abs(by_x[p]) + xsimd::abs(by_y[p]);
            half_range[p] = slope[p] * Doubles(half_size);
            constant[p] = xsimd::fma(Doubles(kFloatError), half_range[p], Doubles::load_unaligned(t.error + i));
            relative[p] = Doubles::load_unaligned(relative_error + i);
            is_depth[p] = Doubles::load_unaligned(depth_only + i);
            most[p] = Doubles::load_unaligned(greatest + i);
        }
    }
};

/// The triangle about one tile: conditions scaled by their errors.
struct TileForms {
    float at[4], by_x[4], by_y[4];
    float by_depth;
};

inline float read_least_depth(const Tile& tile) {
    float value;
    __atomic_load(&tile.least_depth, &value, __ATOMIC_RELAXED);
    return value;
}

inline void store_floats(const Doubles (&values)[kParts], float (&floats)[4]) {
    double stored[4];
    for (int p = 0; p < kParts; ++p) values[p].store_unaligned(stored + p * kDoubles);
    for (int i = 0; i < 4; ++i) floats[i] = float(stored[i]);
}

/// False if the triangle can't shadow any receiver of the tile. `row_at`: the forms at x = 0 in the tile's row.
inline bool make_forms(const CasterForms& f, const Doubles (&row_at)[kParts], double x, const Tile& tile,
                       TileForms& forms) {
    const Doubles place_error(double(tile.place_error)), depth_error(double(tile.depth_error));
    const Doubles least(double(read_least_depth(tile)));
    Doubles at[kParts], scale[kParts];
    for (int p = 0; p < kParts; ++p) {
        at[p] = xsimd::fma(Doubles(x), f.by_x[p], row_at[p]);
        Doubles error = xsimd::fma(f.relative[p], xsimd::abs(at[p]), f.constant[p]);
        error = xsimd::fma(f.is_depth[p], depth_error, xsimd::fma(f.slope[p], place_error, error));
        const Doubles most = xsimd::min(at[p] + f.half_range[p], f.most[p]) + error;
        if (xsimd::any(most < f.is_depth[p] * least)) return false;
        scale[p] = Doubles(1.0) / (error + Doubles(1e-300));
    }
    Doubles by_x[kParts], by_y[kParts];
    for (int p = 0; p < kParts; ++p) {
        at[p] *= scale[p];
        by_x[p] = f.by_x[p] * scale[p];
        by_y[p] = f.by_y[p] * scale[p];
    }
    store_floats(at, forms.at);
    store_floats(by_x, forms.by_x);
    store_floats(by_y, forms.by_y);
    double last[kDoubles];
    scale[kParts - 1].store_unaligned(last);
    forms.by_depth = float(-last[kDoubles - 1]);
    return true;
}

/// Receivers of a tile while one thread has it to itself.
class HeldTile {
public:
    HeldTile(Tile& tile, ReceiverBlock* blocks) : tile_(tile), blocks_(blocks + tile.first) {
        while (__atomic_exchange_n(&tile_.busy, 1u, __ATOMIC_ACQUIRE)) sched_yield();
        count_ = tile_.count;
    }
    ~HeldTile() {
        if (count_ != tile_.count) {
            const float least = find_least_depth();
            __atomic_store(&tile_.least_depth, &least, __ATOMIC_RELAXED);
            __atomic_store_n(&tile_.count, count_, __ATOMIC_RELAXED);
        }
        __atomic_store_n(&tile_.busy, 0u, __ATOMIC_RELEASE);
    }
    HeldTile(const HeldTile&) = delete;
    HeldTile& operator=(const HeldTile&) = delete;

    std::uint32_t count() const { return count_; }
    ReceiverBlock& block(std::uint32_t index) { return blocks_[index]; }
    /// The last receiver takes the place of this one.
    void remove(ReceiverBlock& block, std::uint32_t lane) {
        --count_;
        ReceiverBlock& last = blocks_[count_ / ReceiverBlock::kLanes];
        const std::uint32_t from = count_ % ReceiverBlock::kLanes;
        block.x[lane] = last.x[from];
        block.y[lane] = last.y[from];
        block.depth[lane] = last.depth[from];
        block.instance[lane] = last.instance[from];
        block.triangle[lane] = last.triangle[from];
        block.pixel[lane] = last.pixel[from];
        last.depth[from] = __builtin_inff();
    }

private:
    float find_least_depth() const {
        Floats least(__builtin_inff());  // as empty lanes are
        for (std::uint32_t i = 0; i < count_; i += kFloats)
            least = xsimd::min(
                least, Floats::load_aligned(blocks_[i / ReceiverBlock::kLanes].depth + i % ReceiverBlock::kLanes));
        float values[kFloats], result = __builtin_inff();
        least.store_unaligned(values);
        for (const float value : values) result = value < result ? value : result;
        return result;
    }

    Tile& tile_;
    ReceiverBlock* blocks_;
    std::uint32_t count_;
};

inline void note_open(Answers& answers, std::uint32_t pixel, const CasterTriangle& t) {
    if (answers.open_count == answers.open_capacity) answers.settle(answers.context, answers);
    answers.open[answers.open_count++] = {pixel, t.instance, t.triangle};
}

/// Receivers from `begin` on that may be in shadow, from the last one down: a removed receiver's place is taken by the
/// tile's last one, which is looked at already.
inline void take_lanes(const CasterTriangle& t, const float (&values)[kFloats], std::uint32_t begin, HeldTile& held,
                       Answers& answers) {
    ReceiverBlock& block = held.block(begin / ReceiverBlock::kLanes);
    for (std::uint32_t i = kFloats; i-- > 0;) {
        if (!(values[i] >= -1.0f) || begin + i >= held.count()) continue;
        const std::uint32_t lane = begin % ReceiverBlock::kLanes + i, pixel = block.pixel[lane];
        if (values[i] > 1.0f) {
            __atomic_store_n(answers.visible + pixel, std::uint8_t(0), __ATOMIC_RELAXED);
            held.remove(block, lane);
        } else {
            note_open(answers, pixel, t);
        }
    }
}

inline void test_tile(const CasterTriangle& t, const TileForms& f, Tile& tile, ReceiverBlock* blocks,
                      Answers& answers) {
    HeldTile held(tile, blocks);
    answers.tests += held.count();
    for (std::uint32_t end = (held.count() + kFloats - 1) / kFloats * kFloats; end > 0; end -= kFloats) {
        const ReceiverBlock& block = held.block((end - kFloats) / ReceiverBlock::kLanes);
        const std::uint32_t lane = (end - kFloats) % ReceiverBlock::kLanes;
        const Floats x = Floats::load_aligned(block.x + lane), y = Floats::load_aligned(block.y + lane);
        Floats least = xsimd::fma(y, Floats(f.by_y[3]), xsimd::fma(x, Floats(f.by_x[3]), Floats(f.at[3])));
        least = xsimd::fma(Floats::load_aligned(block.depth + lane), Floats(f.by_depth), least);
        for (int i = 0; i < 3; ++i)
            least =
                xsimd::min(least, xsimd::fma(y, Floats(f.by_y[i]), xsimd::fma(x, Floats(f.by_x[i]), Floats(f.at[i]))));
        if (!xsimd::any(least >= Floats(-1.0f))) continue;
        const auto is_own = load_words(block.instance + lane) == Words(std::int32_t(t.instance)) &&
                            load_words(block.triangle + lane) == Words(std::int32_t(t.triangle));
        least = xsimd::select(xsimd::bool_cast(is_own), Floats(kOutside), least);
        if (!xsimd::any(least >= Floats(-1.0f))) continue;
        float values[kFloats];
        least.store_unaligned(values);
        take_lanes(t, values, end - kFloats, held, answers);
    }
}

struct Columns {
    int begin, end;
};

/// What the edges leave of the triangle's columns in the row of tiles about `y`, and at most one tile more on each
/// side.
inline Columns narrow_columns(const CasterTriangle& t, double y, const Tiles& tiles) {
    double low = -1, high = 1;
    for (int i = 0; i < 3; ++i) {
        const double at = t.at[i] + y * t.by_y[i], by_x = t.by_x[i];
        const double slope = magnitude(by_x) + magnitude(t.by_y[i]);
        const double error = kFloatError * (magnitude(at) + magnitude(by_x) + slope * tiles.half_size) +
                             slope * double(tiles.largest_place_error) + t.error[i];
        const double most = at + slope * tiles.half_size + error;  // + x by_x >= 0 where the edge leaves something
        if (by_x > 0)
            low = larger(low, -most / by_x);
        else if (by_x < 0)
            high = smaller(high, most / -by_x);
        else if (most < 0)
            return {0, 0};
    }
    if (!(low <= high)) return {0, 0};
    const int begin = int((low + 1) * 0.5 * tiles.side) - 1, end = int((high + 1) * 0.5 * tiles.side) + 2;
    return {begin > t.extent.column_begin ? begin : t.extent.column_begin,
            end < t.extent.column_end ? end : t.extent.column_end};
}

/// The block that is tested first, while the tile's forms are made.
inline void fetch_ahead(const ReceiverBlock& block) {
    __builtin_prefetch(block.x);
    __builtin_prefetch(block.depth);
}

inline void draw_triangle(const CasterTriangle& t, int row_begin, int row_end, const Tiles& tiles, Answers& answers) {
    const CasterForms caster(t, tiles.half_size);
    const int from = t.extent.row_begin > row_begin ? t.extent.row_begin : row_begin,
              to = t.extent.row_end < row_end ? t.extent.row_end : row_end;
    TileForms forms;
    Doubles row_at[kParts];
    for (int row = from; row < to; ++row) {
        const double y = (2 * row + 1) * tiles.half_size - 1;
        for (int p = 0; p < kParts; ++p) row_at[p] = xsimd::fma(Doubles(y), caster.by_y[p], caster.at[p]);
        Columns columns{t.extent.column_begin, t.extent.column_end};
        if (columns.end - columns.begin > kNarrow) columns = narrow_columns(t, y, tiles);
        Tile* const tile_row = tiles.tiles + std::size_t(row) * std::size_t(tiles.side);
        for (int column = columns.begin; column < columns.end; ++column) {
            Tile& tile = tile_row[column];
            const std::uint32_t count = __atomic_load_n(&tile.count, __ATOMIC_RELAXED);
            if (count == 0 || (tile.instance == t.instance && tile.triangle == t.triangle)) continue;
            fetch_ahead(tiles.blocks[tile.first + (count - 1) / ReceiverBlock::kLanes]);
            const double x = (2 * column + 1) * tiles.half_size - 1;
            if (make_forms(caster, row_at, x, tile, forms)) test_tile(t, forms, tile, tiles.blocks, answers);
        }
    }
}

inline void draw_triangles(const CasterTriangle* triangles, std::size_t count, int row_begin, int row_end,
                           const Tiles& tiles, Answers& answers) {
    for (std::size_t i = 0; i < count; ++i) draw_triangle(triangles[i], row_begin, row_end, tiles, answers);
}

}  // namespace
}  // namespace shadow_layers::tile_kernel
