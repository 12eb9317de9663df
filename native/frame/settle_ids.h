// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/engine.h"
#include "frame/frame.h"

namespace shadow_layers {

/// Gives each pixel the triangle that the ray of its centre meets.
///
/// A GL snaps corners to its raster's grid, often of 1/256 pixel, so centres that lie nearer to an edge than that may
/// fall to the triangle beyond it. Their receivers would lie past that triangle's rim: in a hollow, underneath the
/// triangle that they belong to and in its shadow.
///
/// `frame.ids` are the raster's; all else but positions, normals and coverage must be there. A pixel whose ray passes
/// by its triangle gets the nearest one that the ray meets among those that share a vertex with it and those of the
/// pixels around; if there is none it keeps what it has. In double.
void settle_ids(Engine& engine, Frame& frame);

}  // namespace shadow_layers
