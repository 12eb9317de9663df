// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/tile_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shadow_layers {
namespace {

using tile_kernel::ReceiverBlock;
using tile_kernel::Tile;

constexpr std::size_t kTileBlock = 1 << 12;
constexpr std::uint32_t kLanes = ReceiverBlock::kLanes;
// A float position is off by half a unit in the last place on each axis; the root of 3 and a reserve make it this.
constexpr double kPositionRounding = 1.0 / 8388608.0;  // 2^-23

/// Empty lanes get what the tile's first receiver has, so that whole blocks can be looked at.
void fill_lanes(const Tile& tile, ReceiverBlock* blocks) {
    for (std::uint32_t i = tile.count; i % kLanes != 0; ++i) {
        ReceiverBlock& block = blocks[i / kLanes];
        block.depth[i % kLanes] = blocks->depth[0];
        block.instance[i % kLanes] = blocks->instance[0];
        block.triangle[i % kLanes] = blocks->triangle[0];
    }
}

/// Nothing shadows an empty lane.
void close_lanes(const Tile& tile, ReceiverBlock* blocks) {
    for (std::uint32_t i = tile.count; i % kLanes != 0; ++i)
        blocks[i / kLanes].depth[i % kLanes] = std::numeric_limits<float>::infinity();
}

/// Sets the tile's least depth, and its surface if all lanes are on one: a triangle never shadows what lies on it, so
/// tiles that see it alone are passed over. Returns the greatest depth.
float bound_lanes(Tile& tile, const ReceiverBlock* blocks) {
    float least[kLanes], greatest[kLanes];
    std::uint32_t other[kLanes] = {};
    std::copy_n(blocks->depth, kLanes, least);
    std::copy_n(blocks->depth, kLanes, greatest);
    const std::uint32_t instance = blocks->instance[0], triangle = blocks->triangle[0];
    for (std::uint32_t begin = 0; begin < tile.count; begin += kLanes) {
        const ReceiverBlock& block = blocks[begin / kLanes];
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
            const float depth = block.depth[lane];
            least[lane] = depth < least[lane] ? depth : least[lane];
            greatest[lane] = depth > greatest[lane] ? depth : greatest[lane];
            other[lane] |= (block.instance[lane] ^ instance) | (block.triangle[lane] ^ triangle);
        }
    }
    tile.least_depth = *std::min_element(least, least + kLanes);
    if (std::all_of(other, other + kLanes, [](std::uint32_t bits) { return bits == 0; })) {
        tile.instance = instance;
        tile.triangle = triangle;
    }
    return *std::max_element(greatest, greatest + kLanes);
}

}  // namespace

// With position error e, x = X / w is off by e (|X row| + |x| |w row|) / w, and depth likewise. 1 / w follows from the
// depth: z = alpha + beta w for a perspective view.
void bound_tiles(ReceiverTiles& tiles, const LightView& view, const glm::dmat4& clip_rows, double farthest,
                 ThreadPool& threads) {
    glm::dvec4 length(0.0);
    for (int i = 0; i < 4; ++i) length[i] = glm::length(glm::dvec3(clip_rows[i]));
    const double error = kPositionRounding * farthest, near = view.near_ls, far = view.far_ls;
    threads.parallel_for(tiles.tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t index = begin; index < end; ++index) {
            Tile& tile = tiles.tiles[index];
            if (tile.count == 0) continue;
            ReceiverBlock* const blocks = tiles.blocks + tile.first;
            fill_lanes(tile, blocks);
            const double greatest = bound_lanes(tile, blocks), least = tile.least_depth;
            close_lanes(tile, blocks);
            // depth = near (far - w) / (w (far - near)): 1 / w = (depth (far - near) / near + 1) / far
            const double over_w = view.perspective ? std::max((greatest * (far - near) / near + 1) / far, 1e-300) : 1.0;
            const double largest = std::max(std::abs(least), std::abs(greatest));
            tile.place_error = float(error * over_w * (std::max(length.x, length.y) + length.w));
            tile.depth_error = float(error * over_w * (length.z + largest * length.w));
        }
    });
    tiles.largest_place_error = 0;
    for (const Tile& tile : tiles.tiles)
        tiles.largest_place_error = std::max(tiles.largest_place_error, tile.place_error);
}

}  // namespace shadow_layers
