// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <iterator>
#include <limits>
#include <type_traits>

#include "visibility/tile_kernel.h"

namespace shadow_layers {

/// The tiles of a view that casters are set up for.
class CasterGrid {
public:
    /// `place_margin`: by how many clip units a receiver may be off its place. Without tiles none is asked for.
    CasterGrid(int tiles_per_side, double place_margin) : side(tiles_per_side), margin(place_margin) {}
    /// `tiles`: side x side, row-major, of any kind.
    template <class Tile>
    CasterGrid(int tiles_per_side, double place_margin, const Tile* tiles)
        : side(tiles_per_side),
          margin(place_margin),
          tiles_(reinterpret_cast<const std::byte*>(tiles)),
          stride_(sizeof(Tile)) {
        static_assert(std::is_base_of_v<tile_kernel::TileContent, Tile>);
    }

    bool has_tiles() const { return tiles_ != nullptr; }
    const tile_kernel::TileContent& tile(int column, int row) const {
        const std::size_t index = std::size_t(row) * std::size_t(side) + std::size_t(column);
        return *reinterpret_cast<const tile_kernel::TileContent*>(tiles_ + index * stride_);
    }

    int side;
    double margin;

private:
    const std::byte* tiles_ = nullptr;
    std::size_t stride_ = 0;
};

/// Clip coordinates: (x, y, w) as edge functions take them, and z.
struct ClipCorner {
    glm::dvec3 xyw;
    double z;
};

inline ClipCorner project_corner(const glm::dmat4& lc_from_object, const glm::dvec3& position) {
    const glm::dvec4 lc = lc_from_object * glm::dvec4(position, 1.0);
    return {{lc.x, lc.y, lc.w}, lc.z};
}

/// Are all corners beyond one side of the view's pyramid? Also right for corners behind the light.
template <std::size_t kCount>
bool is_outside(const ClipCorner (&corners)[kCount], double margin) {
    for (int axis = 0; axis < 2; ++axis)
        for (const double sign : {-1.0, 1.0})
            if (std::all_of(std::begin(corners), std::end(corners), [&](const ClipCorner& c) {
                    return sign * c.xyw[axis] > c.xyw.z + margin * std::abs(c.xyw.z);
                }))
                return true;
    return false;
}

/// Tiles that the convex hull of the corners may touch, and its greatest depth. What reaches behind the light may touch
/// all tiles, at any depth. False if it touches none.
template <std::size_t kCount>
bool find_extent(const ClipCorner (&corners)[kCount], const CasterGrid& grid, tile_kernel::TileExtent& extent) {
    // Corners this much nearer to the light's plane than the farthest one are not divided by w.
    constexpr double kLeastDepthRatio = 1e-9;
    double least = corners[0].xyw.z, most = least;
    for (const ClipCorner& c : corners) {
        least = std::min(least, c.xyw.z);
        most = std::max(most, c.xyw.z);
    }
    if (!(most > 0)) return false;
    if (!(least > kLeastDepthRatio * most)) {
        extent = {0, grid.side, 0, grid.side, std::numeric_limits<double>::infinity()};
        return !is_outside(corners, grid.margin);
    }
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    extent.greatest_depth = -std::numeric_limits<double>::infinity();
    for (const ClipCorner& c : corners) {
        const double over_w = 1 / c.xyw.z;
        const glm::dvec2 place = glm::dvec2(c.xyw) * over_w;
        low = glm::min(low, place);
        high = glm::max(high, place);
        extent.greatest_depth = std::max(extent.greatest_depth, c.z * over_w);
    }
    const double side = grid.side;
    const auto to_tiles = [&](double place) { return std::clamp((place + 1) * 0.5 * side, -1.0, side); };
    extent.column_begin = int(std::max(to_tiles(low.x - grid.margin), 0.0));
    extent.row_begin = int(std::max(to_tiles(low.y - grid.margin), 0.0));
    extent.column_end = std::min(int(to_tiles(high.x + grid.margin) + 1), grid.side);
    extent.row_end = std::min(int(to_tiles(high.y + grid.margin) + 1), grid.side);
    return extent.column_begin < extent.column_end && extent.row_begin < extent.row_end;
}

/// Does a receiver lie behind what has this extent, in a tile that it may touch? True without a look where there are
/// more than `most_tiles` of them. Receivers leave tiles meanwhile, by other threads.
bool may_meet_receivers(const tile_kernel::TileExtent& extent, const CasterGrid& grid, int most_tiles);

}  // namespace shadow_layers
