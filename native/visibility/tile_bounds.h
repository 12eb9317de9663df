// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "base/thread_pool.h"
#include "lights/light_views.h"
#include "visibility/receiver_tiles.h"

namespace shadow_layers {

/// Finds what is known of each tile as a whole: the least depth, the surface if all its receivers lie on one, and how
/// far off their places may be because the frame's positions are rounded. Closes the empty lanes of its blocks.
///
/// `clip_rows`: rows of the view's clip space from the frame's space, as columns. `farthest`: distance of the receivers
/// from the frame's origin, at most.
void bound_tiles(ReceiverTiles& tiles, const LightView& view, const glm::dmat4& clip_rows, double farthest,
                 ThreadPool& threads);

}  // namespace shadow_layers
