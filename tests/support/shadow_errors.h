// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a layer is from the exact shadow, over the pixels that are turned to the light.

#include <array>
#include <cmath>
#include <vector>

#include "frame/frame.h"
#include "lights/facing.h"
#include "lights/light_views.h"

namespace shadow_layers::testing {

struct ShadowErrors {
    double wrong_ppm = 0;
    double acne_ppm = 0;         ///< shadow more than `far_px` pixels from any true shadow
    double leak_ppm = 0;         ///< light as far inside one
    double plane_wrong_ppm = 0;  ///< on instance 0, of its own pixels
    std::size_t pixels = 0;
};

inline ShadowErrors measure_shadow_errors(const Frame& frame, const Light& light, const LightSample& position,
                                          const std::vector<float>& truth, const std::vector<float>& visibility,
                                          int far_px = 4) {
    const FacingRule facing(frame, light, position);
    ShadowErrors errors;
    std::size_t wrong = 0, acne = 0, leak = 0, plane = 0, plane_wrong = 0;
    std::vector<std::uint8_t> counted(truth.size());
    for (std::size_t pixel = 0; pixel < truth.size(); ++pixel)
        counted[pixel] = facing.classify(pixel) == Facing::Undecided;
    const auto is_near = [&](int x, int y, bool lit) {
        for (int v = std::max(0, y - far_px); v <= std::min(frame.height - 1, y + far_px); ++v)
            for (int u = std::max(0, x - far_px); u <= std::min(frame.width - 1, x + far_px); ++u) {
                const std::size_t pixel = std::size_t(v) * std::size_t(frame.width) + std::size_t(u);
                if (counted[pixel] && (truth[pixel] >= 0.5f) == lit) return true;
            }
        return false;
    };
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            const std::size_t pixel = std::size_t(y) * std::size_t(frame.width) + std::size_t(x);
            if (!counted[pixel]) continue;
            const bool lit = truth[pixel] >= 0.5f, is_wrong = lit != (visibility[pixel] >= 0.5f);
            ++errors.pixels;
            plane += frame.ids[pixel].instance == 0;
            if (!is_wrong) continue;
            ++wrong;
            plane_wrong += frame.ids[pixel].instance == 0;
            if (is_near(x, y, !lit)) continue;
            ++(lit ? acne : leak);
        }
    const double scale = 1e6 / double(std::max<std::size_t>(1, errors.pixels));
    errors.wrong_ppm = double(wrong) * scale;
    errors.acne_ppm = double(acne) * scale;
    errors.leak_ppm = double(leak) * scale;
    errors.plane_wrong_ppm = 1e6 * double(plane_wrong) / double(std::max<std::size_t>(1, plane));
    return errors;
}

}  // namespace shadow_layers::testing
