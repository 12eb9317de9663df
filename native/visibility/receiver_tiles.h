// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "frame/receiver_source.h"
#include "lights/light_views.h"
#include "visibility/tile_kernel.h"

namespace shadow_layers {

class ThreadPool;

/// Receivers sorted into the tiles of a light view's map: side x side squares over [-1, 1]^2 of its clip space.
struct ReceiverTiles {
    int side = 1;
    double half_size = 1;  ///< of a tile, in clip units
    std::vector<tile_kernel::Tile> tiles;
    tile_kernel::ReceiverBlock* blocks = nullptr;  ///< of all views; the sorter's
    float largest_place_error = 0;
    std::uint32_t receiver_count = 0;

    /// Middle of a tile on one axis, clip units.
    double middle(int tile) const { return (2 * tile + 1) * half_size - 1; }
};

/// Sorts receivers by light views, frame after frame in the same memory.
class ReceiverSorter {
public:
    /// Takes the receivers whose visibility the casters decide, each to the view that holds it; receivers that no view
    /// holds are left out. There are at most `most_tiles` tiles per side. Within a tile they lie in the order of
    /// the source.
    void sort(const ReceiverSource& receivers, const Light& light, const LightSample& sample, int most_tiles,
              ThreadPool& threads);

    /// In the order of LightSample::views.
    std::vector<ReceiverTiles>& views() { return views_; }
    /// Per receiver: 0 on faces turned away, else 1 until a caster says otherwise.
    std::vector<std::uint8_t>& visible() { return visible_; }
    std::size_t byte_size() const;

private:
    struct Place {
        float x, y, depth;
        std::uint32_t tile, rank;  ///< of all views' tiles; which of the tile's receivers in its part of the picture
        std::uint32_t pixel;
    };
    class Run;

    std::vector<ReceiverTiles> views_;
    std::vector<tile_kernel::ReceiverBlock> blocks_;
    std::vector<std::uint8_t> visible_;
    std::vector<Place> places_;           ///< of each part of the picture, from its first pixel on
    std::vector<std::uint32_t> offsets_;  ///< per part of the picture and tile of all views
};

}  // namespace shadow_layers
