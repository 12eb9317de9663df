// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "engine/engine.h"
#include "frame/receiver_source.h"
#include "lights/light_views.h"
#include "visibility/receiver_tiles.h"

namespace shadow_layers {

/// Exact hard visibility of one light sample, on the CPU: the receivers are sorted into tiles of the light's views
/// and the triangles are drawn over them. Keeps its memory from one frame to the next.
class ExactVisibility {
public:
    /// One byte per receiver (pixel of a frame, or point): 1 = the light reaches the receiver. Faces turned away are 0;
    /// background, receivers outside the cone and unlinked ones are 1. Valid until the next call.
    ///
    /// `most_tiles`: bound of the tiles per side, which are chosen by the picture's size. It changes the time, not the
    /// answer.
    /// Counts "receivers", "list_bytes", "caster_triangles", "tile_tests", "open_pairs" (settled in double).
    const std::vector<std::uint8_t>& compute(Engine& engine, const ReceiverSource& receivers, const Light& light,
                                             const LightSample& sample, int most_tiles);

private:
    ReceiverSorter sorter_;
};

}  // namespace shadow_layers
