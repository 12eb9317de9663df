// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "engine/draw_state.h"

namespace shadow_layers {

class Engine;

/// Calls `draw` for bands of a target's rows, each of bounded work, and listens for a cancel between them: what is
/// given to the driver can't be taken back. `state` says what `draw` draws with, besides the band's rows;
/// `reads_per_pixel` is about how many texels a pixel of the target reads.
void draw_in_bands(Engine& engine, int width, int height, double reads_per_pixel, const DrawState& state,
                   const std::function<void(const DrawState&)>& draw);

/// The same for a triangle over the whole target (Engine::draw_fullscreen).
void draw_fullscreen_in_bands(Engine& engine, int width, int height, double reads_per_pixel,
                              const DrawState& state = {});

}  // namespace shadow_layers
