// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "frame/frame.h"
#include "lights/light_views.h"

namespace shadow_layers {

class ThreadPool;

/// Receivers sorted into the tiles of a light view's map: side x side squares over [-1, 1]^2 of its clip space.
///
/// Places are kept about the middle of their tile, so that float resolves them far below a tile. `depth` is "depth_rz"
/// of the view: larger nearer to the light.
struct ReceiverTiles {
    int side = 1;
    double half_size = 1;  ///< of a tile, in clip units
    // per tile, row-major
    std::vector<std::uint32_t> first, count;
    std::vector<float> least_depth;  ///< of its receivers: of the one farthest from the light
    std::vector<float> place_error;  ///< bound of how far off x, y may be, because the frame's positions are rounded
    std::vector<float> depth_error;
    float largest_place_error = 0;
    std::uint32_t receiver_count = 0;
    // per receiver
    std::vector<float> x, y, depth;
    std::vector<std::uint32_t> pixel;

    std::size_t byte_size() const {
        return (5 * count.size() + 4 * x.size()) * sizeof(std::uint32_t);  // all are numbers of four bytes
    }
    /// Middle of a tile on one axis, clip units.
    double middle(int tile) const { return (2 * tile + 1) * half_size - 1; }
};

/// Entries behind the last receiver, for blocks of SIMD lanes that reach past it.
inline constexpr std::size_t kTilePadding = 32;

struct SortedReceivers {
    std::vector<ReceiverTiles> views;   ///< in the order of LightPosition::views
    std::vector<std::uint8_t> visible;  ///< per pixel: 0 on faces turned away, else 1 until a caster says otherwise
};

/// The receivers whose visibility the casters decide, each in the view that holds it; receivers that no view holds are
/// left out. There are at most `most_tiles` tiles per side. The order within a tile may differ from run to run.
SortedReceivers sort_receivers(const Frame& frame, const Light& light, const LightPosition& position, int most_tiles,
                               ThreadPool& threads);

}  // namespace shadow_layers
