// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/fsasm/silhouette_mask.h"

#include <algorithm>
#include <cmath>

namespace shadow_layers {
namespace {

// Edges come in float texels: in the largest map this is more than they are rounded.
constexpr float kEdgeMargin = 1.0f / 256;
// Rounding of an edge's depth against the map's: some units in the last place of numbers up to 1.
constexpr float kDepthRounding = 1.0f / 1048576;

class Marker {
public:
    Marker(int side, std::span<const float> depth_rz)
        : side_(side), depth_rz_(depth_rz), marks_(std::size_t(side) * std::size_t(side)) {}

    /// Texel by texel of each row that the edge passes, like the cut of a line with a slab.
    void mark(const MapEdge& edge) {
        const glm::vec4 &a = edge.start.y <= edge.end.y ? edge.start : edge.end,
                        &b = &a == &edge.start ? edge.end : edge.start;
        const int first = clamp_texel(a.y - kEdgeMargin), last = clamp_texel(b.y + kEdgeMargin);
        if (b.y + kEdgeMargin < 0 || a.y - kEdgeMargin > float(side_)) return;
        for (int row = first; row <= last; ++row) {
            const float from = find_part(a, b, float(row) - kEdgeMargin),
                        to = find_part(a, b, float(row + 1) + kEdgeMargin);
            mark_row(row, glm::mix(a, b, from), glm::mix(a, b, to));
        }
    }

    std::vector<std::uint8_t> take() { return std::move(marks_); }

private:
    int clamp_texel(float place) const { return int(std::clamp(std::floor(place), 0.0f, float(side_ - 1))); }

    /// Part of the way from a to b at which a row's border is met; the nearer end where it is not.
    static float find_part(const glm::vec4& a, const glm::vec4& b, float y) {
        const float rise = b.y - a.y;
        if (!(rise > 0)) return y > a.y ? 1.0f : 0.0f;
        return std::clamp((y - a.y) / rise, 0.0f, 1.0f);
    }

    void mark_row(int row, const glm::vec4& a, const glm::vec4& b) {
        const float low = std::min(a.x, b.x) - kEdgeMargin, high = std::max(a.x, b.x) + kEdgeMargin;
        if (high < 0 || low > float(side_)) return;
        const float nearest = std::max(a.z, b.z) + kDepthRounding;
        for (int column = clamp_texel(low); column <= clamp_texel(high); ++column) {
            std::uint8_t& texel = marks_[index(column, row)];
            if (!texel && find_farthest(column, row) <= nearest) texel = 1;
        }
    }

    std::size_t index(int column, int row) const { return std::size_t(row) * std::size_t(side_) + std::size_t(column); }

    float find_farthest(int column, int row) const {
        if (column == 0 || row == 0 || column == side_ - 1 || row == side_ - 1)
            return 0;  // what lies beyond is unknown
        float farthest = 1;
        for (int j = row - 1; j <= row + 1; ++j)
            for (int i = column - 1; i <= column + 1; ++i) farthest = std::min(farthest, depth_rz_[index(i, j)]);
        return farthest;
    }

    int side_;
    std::span<const float> depth_rz_;
    std::vector<std::uint8_t> marks_;
};

}  // namespace

SilhouetteMask::SilhouetteMask(int side, std::span<const std::uint8_t> texels)
    : side_(side), sums_(std::size_t(side + 1) * std::size_t(side + 1)) {
    for (int row = 0; row < side; ++row) {
        const std::uint8_t* marks = texels.data() + std::size_t(row) * std::size_t(side);
        const std::uint32_t* below = sums_.data() + std::size_t(row) * std::size_t(side + 1);
        std::uint32_t* sums = sums_.data() + std::size_t(row + 1) * std::size_t(side + 1);
        std::uint32_t in_row = 0;
        for (int column = 0; column < side; ++column) {
            in_row += marks[column] != 0;
            sums[column + 1] = below[column + 1] + in_row;
        }
    }
}

std::vector<std::uint8_t> mark_silhouette_texels(std::span<const MapEdge> edges, int side,
                                                 std::span<const float> depth_rz) {
    Marker marker(side, depth_rz);
    for (const MapEdge& edge : edges) marker.mark(edge);
    return marker.take();
}

}  // namespace shadow_layers
