// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/thread_pool.h"
#include "frame/frame.h"
#include "techniques/afsm/receiver_list.h"
#include "visibility/receiver_tiles.h"
#include "visibility/tile_kernel.h"

namespace shadow_layers {

/// The receivers of a view, about the texels of a map, and the pixels that see them.
struct PlacedReceivers {
    std::vector<ListReceiver> receivers;
    std::vector<std::uint32_t> pixels;

    std::size_t byte_size() const {
        return receivers.size() * sizeof(ListReceiver) + pixels.size() * sizeof(std::uint32_t);
    }
};

/// In the order of `sorted`; the map has side x side texels.
PlacedReceivers make_list_receivers(const ReceiverTiles& sorted, int side, ThreadPool& threads);

/// A caster that is set up over the texels of a map of side x side, in float with bounds of its errors.
ListCaster make_list_caster(const tile_kernel::CasterTriangle& triangle, int side);

}  // namespace shadow_layers
