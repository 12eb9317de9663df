// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/banded_draw.h"

#include <algorithm>

#include "engine/engine.h"

namespace shadow_layers {
namespace {

constexpr double kReadsPerBand = 1e8;  // 50 to 100 ms on a software rasteriser with two threads

}  // namespace

void draw_in_bands(Engine& engine, int width, int height, double reads_per_pixel, const DrawState& state,
                   const std::function<void(const DrawState&)>& draw) {
    const double rows = kReadsPerBand / (std::max(1.0, reads_per_pixel) * std::max(1, width));
    const int band = std::clamp(int(std::min(rows, double(height))), 1, std::max(1, height));
    for (int y = 0; y < height; y += band) {
        engine.check_cancelled();
        DrawState band_state = state;
        band_state.row_begin = y;
        band_state.row_count = std::min(band, height - y);
        draw(band_state);
        if (band < height) engine.limit_queue();
    }
}

void draw_fullscreen_in_bands(Engine& engine, int width, int height, double reads_per_pixel, const DrawState& state) {
    draw_in_bands(engine, width, height, reads_per_pixel, state,
                  [&](const DrawState& band) { engine.draw_fullscreen(band); });
}

}  // namespace shadow_layers
