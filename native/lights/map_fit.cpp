// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/map_fit.h"

#include <algorithm>
#include <cmath>

namespace shadow_layers {

namespace {

constexpr double kStepsPerOctave = 16;
constexpr double kMostOctaves = 12;
constexpr int kLeastTexelsToSnap = 8;
/// Receivers as wide as the frame itself must not miss the first step by rounding; costs 4e-5 of the size.
constexpr double kStepTolerance = 1e-3;
/// Symmetric scenes put the start exactly between two texels: rounding at an odd place keeps noise from choosing.
constexpr double kRounding = 0.62;

}  // namespace

Interval fit_map_interval(const Interval& receivers, const Interval& frame, int texel_count) {
    const double least = frame.size() * std::exp2(-kMostOctaves);
    if (texel_count < kLeastTexelsToSnap) {
        const double half = 0.5 * std::max(receivers.size() * (1 + 1e-4), least);
        return {receivers.middle() - half, receivers.middle() + half};
    }
    // Two texels more than the receivers need: rounding the start moves it by up to 0.62 texels.
    const double with_spare = double(texel_count) / (texel_count - 2);
    const double wanted = std::max(receivers.size(), least) * with_spare;
    const double step = std::floor(kStepsPerOctave * std::log2(frame.size() * with_spare / wanted) + kStepTolerance);
    const double size = frame.size() * with_spare * std::exp2(-step / kStepsPerOctave);
    const double texel = size / texel_count;
    const double start = std::floor((receivers.middle() - 0.5 * size - frame.middle()) / texel + kRounding);
    const double low = frame.middle() + start * texel;
    return {low, low + size};
}

}  // namespace shadow_layers
