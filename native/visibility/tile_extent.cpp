// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/tile_extent.h"

namespace shadow_layers {
namespace {

using tile_kernel::TileContent;

// Of a depth that is kept as a float, with a reserve.
constexpr double kFloatRounding = 1.0 / 8388608.0;  // 2^-23

/// Is a receiver of the tile farther from the light than that depth?
bool has_receivers_behind(const TileContent& tile, double depth) {
    if (__atomic_load_n(&tile.count, __ATOMIC_RELAXED) == 0) return false;
    float least;
    __atomic_load(&tile.least_depth, &least, __ATOMIC_RELAXED);
    return depth + double(tile.depth_error) + kFloatRounding * std::abs(depth) >= double(least);
}

}  // namespace

bool may_meet_receivers(const tile_kernel::TileExtent& extent, const CasterGrid& grid, int most_tiles) {
    if (!grid.has_tiles() || extent.tile_count() > most_tiles) return true;
    for (int row = extent.row_begin; row < extent.row_end; ++row)
        for (int column = extent.column_begin; column < extent.column_end; ++column)
            if (has_receivers_behind(grid.tile(column, row), extent.greatest_depth)) return true;
    return false;
}

}  // namespace shadow_layers
