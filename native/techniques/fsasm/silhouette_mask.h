// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/map_edges.h"
#include "techniques/fsasm/facet.h"

namespace shadow_layers {

/// The silhouette mask map of one view ([Pan09] 3.2): the texels that a silhouette edge crosses and that are not hidden
/// behind nearer casters, with their summed-area table.
class SilhouetteMask {
public:
    /// Row-major marks of side x side texels, not 0 = a silhouette.
    SilhouetteMask(int side, std::span<const std::uint8_t> texels);

    int side() const { return side_; }
    /// Silhouette texels in a rectangle, by four look-ups.
    std::uint32_t count(const TexelRect& rect) const {
        return at(rect.column_end, rect.row_end) - at(rect.column_begin, rect.row_end) -
               at(rect.column_end, rect.row_begin) + at(rect.column_begin, rect.row_begin);
    }
    std::uint32_t count() const { return sums_.back(); }
    std::size_t byte_size() const { return sums_.size() * sizeof(sums_[0]); }

private:
    std::uint32_t at(int column, int row) const {
        return sums_[std::size_t(row) * std::size_t(side_ + 1) + std::size_t(column)];
    }
    int side_;
    std::vector<std::uint32_t> sums_;  ///< (side + 1)^2: of all texels below and to the left
};

/// Marks the texels of a map of side x side that the edges cross. `depth_rz`: the map's depths, reversed; an edge that
/// lies behind all depths in and round a texel is hidden there. The farthest of them is asked, because the surface at
/// the edge may rise towards the light within a texel.
std::vector<std::uint8_t> mark_silhouette_texels(std::span<const MapEdge> edges, int side,
                                                 std::span<const float> depth_rz);

}  // namespace shadow_layers
