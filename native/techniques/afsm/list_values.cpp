// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/afsm/list_values.h"

#include <algorithm>
#include <cmath>

namespace shadow_layers {
namespace {

constexpr std::size_t kTileBlock = 1 << 10;
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
glm::vec4 make_float_form(const tile_kernel::LinearForm& form, double error, int column, int row, int side,
                          bool scaled) {
    const double texel = 2.0 / side;
    const double at = form.at_origin + form.by_x * ((column + 0.5) * texel - 1) + form.by_y * ((row + 0.5) * texel - 1);
    const double by_u = form.by_x * texel, by_v = form.by_y * texel;
    double scale = 1;
    if (scaled) {
        const double slope = std::abs(by_u) + std::abs(by_v);
        const double size = slope > 0 ? slope : std::abs(at);
        scale = size > 0 ? 1 / size : 1;
    }
    return {float(at * scale), float(by_u * scale), float(by_v * scale), float(error * scale * (1 + kFloatRounding))};
}

}  // namespace

std::vector<ListReceiver> make_list_receivers(const Frame& frame, const ReceiverTiles& sorted, int side,
                                              ThreadPool& threads) {
    std::vector<ListReceiver> receivers(sorted.receiver_count);
    const double to_texels = 0.5 * side;
    threads.parallel_for(sorted.count.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t tile = begin; tile < end; ++tile) {
            const double x = sorted.middle(int(tile % std::size_t(sorted.side)));
            const double y = sorted.middle(int(tile / std::size_t(sorted.side)));
            // A place in a tile is rounded, too.
            const double error = double(sorted.place_error[tile]) + kFloatRounding * sorted.half_size;
            const std::uint32_t first = sorted.first[tile];
            for (std::uint32_t slot = first; slot < first + sorted.count[tile]; ++slot) {
                ListReceiver& receiver = receivers[slot];
                const std::uint32_t column = place_in_texel(x + double(sorted.x[slot]), side, receiver.x);
                const std::uint32_t row = place_in_texel(y + double(sorted.y[slot]), side, receiver.y);
                receiver.texel = row * std::uint32_t(side) + column;
                receiver.depth = sorted.depth[slot];
                receiver.place_error = float((error * to_texels + kFloatRounding) * (1 + kFloatRounding));
                receiver.depth_error = sorted.depth_error[tile];
                const PixelIds& ids = frame.ids[sorted.pixel[slot]];
                receiver.instance = ids.instance;
                receiver.triangle = ids.triangle;
            }
        }
    });
    return receivers;
}

ListCaster make_list_caster(const tile_kernel::CasterTriangle& t, int side) {
    const int column = (t.column_begin + t.column_end) / 2, row = (t.row_begin + t.row_end) / 2;  // as in casters.vert
    ListCaster caster{};
    for (int i = 0; i < 3; ++i) caster.edges[i] = make_float_form(t.edges[i], t.edge_error[i], column, row, side, true);
    caster.depth = make_float_form(t.depth, t.depth_error, column, row, side, false);
    caster.rect = {t.column_begin, t.row_begin, t.column_end, t.row_end};
    caster.instance = t.instance;
    caster.triangle = t.triangle;
    const double top = t.greatest_depth + kTopMargin * (1 + std::abs(t.greatest_depth));
    caster.top = float(std::clamp(top, kTopMargin, 1.0));
    return caster;
}

}  // namespace shadow_layers
