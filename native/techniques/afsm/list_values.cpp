// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/afsm/list_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace shadow_layers {
namespace {

constexpr std::size_t kTileBlock = 1 << 10;
constexpr std::uint32_t kLanes = tile_kernel::ReceiverBlock::kLanes;
// Of a value that becomes a float, with a reserve.
constexpr double kFloatRounding = 1.0 / 8388608.0;  // 2^-23
// What a quad's depth may be off where it is compared: far more than the rounding of the rasteriser.
constexpr double kTopMargin = 1e-5;

/// Texel of a place in clip units, and the place from its middle in texels.
std::uint32_t place_in_texel(double place, int side, float& from_middle) {
    const double texels = (place + 1) * 0.5 * side;
    const int texel = std::clamp(int(std::floor(texels)), 0, side - 1);
    from_middle = float(texels - texel - 0.5);
    return std::uint32_t(texel);
}

/// A form about the middle of a texel, in texels. Its size does not matter for an edge, so it is scaled to a slope of
/// 1, far from where float ends.
glm::vec4 make_float_form(const tile_kernel::CasterTriangle& t, int form, int column, int row, int side, bool scaled) {
    const double texel = 2.0 / side;
    const double at =
        t.at[form] + t.by_x[form] * ((column + 0.5) * texel - 1) + t.by_y[form] * ((row + 0.5) * texel - 1);
    const double by_u = t.by_x[form] * texel, by_v = t.by_y[form] * texel;
    double scale = 1;
    if (scaled) {
        const double slope = std::abs(by_u) + std::abs(by_v);
        const double size = slope > 0 ? slope : std::abs(at);
        scale = size > 0 ? 1 / size : 1;
    }
    return {float(at * scale), float(by_u * scale), float(by_v * scale),
            float(t.error[form] * scale * (1 + kFloatRounding))};
}

}  // namespace

PlacedReceivers make_list_receivers(const ReceiverTiles& sorted, int side, ThreadPool& threads) {
    PlacedReceivers placed{std::vector<ListReceiver>(sorted.receiver_count),
                           std::vector<std::uint32_t>(sorted.receiver_count)};
    std::vector<std::uint32_t> first(sorted.tiles.size());
    std::uint32_t total = 0;
    for (std::size_t index = 0; index < first.size(); ++index)
        first[index] = std::exchange(total, total + sorted.tiles[index].count);
    const double to_texels = 0.5 * side;
    threads.parallel_for(first.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t index = begin; index < end; ++index) {
            const tile_kernel::Tile& tile = sorted.tiles[index];
            const double x = sorted.middle(int(index % std::size_t(sorted.side)));
            const double y = sorted.middle(int(index / std::size_t(sorted.side)));
            // A place in a tile is rounded, too.
            const double error = double(tile.place_error) + kFloatRounding * sorted.half_size;
            for (std::uint32_t i = 0; i < tile.count; ++i) {
                const tile_kernel::ReceiverBlock& block = sorted.blocks[tile.first + i / kLanes];
                ListReceiver& receiver = placed.receivers[first[index] + i];
                const std::uint32_t column = place_in_texel(x + double(block.x[i % kLanes]), side, receiver.x);
                const std::uint32_t row = place_in_texel(y + double(block.y[i % kLanes]), side, receiver.y);
                receiver.texel = row * std::uint32_t(side) + column;
                receiver.depth = block.depth[i % kLanes];
                receiver.place_error = float((error * to_texels + kFloatRounding) * (1 + kFloatRounding));
                receiver.depth_error = tile.depth_error;
                placed.pixels[first[index] + i] = block.pixel[i % kLanes];
                receiver.instance = block.instance[i % kLanes];
                receiver.triangle = block.triangle[i % kLanes];
            }
        }
    });
    return placed;
}

ListCaster make_list_caster(const tile_kernel::CasterTriangle& t, int side) {
    const int column = (t.extent.column_begin + t.extent.column_end) / 2,
              row = (t.extent.row_begin + t.extent.row_end) / 2;  // as in casters.vert
    ListCaster caster{};
    for (int i = 0; i < 3; ++i) caster.edges[i] = make_float_form(t, i, column, row, side, true);
    caster.depth = make_float_form(t, 3, column, row, side, false);
    caster.rect = {t.extent.column_begin, t.extent.row_begin, t.extent.column_end, t.extent.row_end};
    caster.instance = t.instance;
    caster.triangle = t.triangle;
    const double top = t.extent.greatest_depth + kTopMargin * (1 + std::abs(t.extent.greatest_depth));
    caster.top = float(std::clamp(top, kTopMargin, 1.0));
    return caster;
}

}  // namespace shadow_layers
