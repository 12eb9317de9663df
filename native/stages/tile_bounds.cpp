// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/tile_bounds.h"

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

/// Sets the tile's least depth and closes its empty lanes. Returns the greatest depth.
float bound_depths(Tile& tile, ReceiverBlock* blocks) {
    float least = std::numeric_limits<float>::infinity(), greatest = -least;
    for (std::uint32_t i = 0; i < tile.count; ++i) {
        const float depth = blocks[i / kLanes].depth[i % kLanes];
        least = std::min(least, depth);
        greatest = std::max(greatest, depth);
    }
    for (std::uint32_t i = tile.count; i % kLanes != 0; ++i)
        blocks[i / kLanes].depth[i % kLanes] = std::numeric_limits<float>::infinity();
    tile.least_depth = least;
    return greatest;
}

/// A triangle never shadows what lies on it: tiles that see it alone are passed over.
void find_surface(Tile& tile, const ReceiverBlock* blocks) {
    for (std::uint32_t i = 1; i < tile.count; ++i)
        if (blocks[i / kLanes].instance[i % kLanes] != blocks->instance[0] ||
            blocks[i / kLanes].triangle[i % kLanes] != blocks->triangle[0])
            return;
    tile.instance = blocks->instance[0];
    tile.triangle = blocks->triangle[0];
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
            const double greatest = bound_depths(tile, blocks), least = tile.least_depth;
            find_surface(tile, blocks);
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
