// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/pixel_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shadow_layers {
namespace {

// Steps of the table that the filter is inverted with; 1e-3 of its width is far below what a picture shows.
constexpr int kTableSteps = 1024;

/// Cumulative weight at the table's steps, from 0 to 1.
std::vector<double> make_cumulative(const PixelFilter& filter) {
    std::vector<double> cumulative(kTableSteps + 1, 0.0);
    for (int i = 0; i < kTableSteps; ++i) {
        const double x_px = ((i + 0.5) / kTableSteps - 0.5) * filter.width_px;
        cumulative[std::size_t(i) + 1] = cumulative[std::size_t(i)] + evaluate_pixel_filter(filter, x_px);
    }
    for (double& value : cumulative) value /= cumulative.back();
    return cumulative;
}

double invert(const std::vector<double>& cumulative, double fraction, double width_px) {
    const auto above = std::upper_bound(cumulative.begin() + 1, cumulative.end() - 1, fraction);
    const double low = *(above - 1), high = *above;
    const double within = high > low ? (fraction - low) / (high - low) : 0.5;
    const double step = double(above - cumulative.begin()) - 1.0 + within;
    return (step / kTableSteps - 0.5) * width_px;
}

/// The bits of `index` mirrored about the binary point.
double radical_inverse(unsigned index) {
    double value = 0, digit = 0.5;
    for (; index; index >>= 1, digit *= 0.5)
        if (index & 1) value += digit;
    return value;
}

}  // namespace

double evaluate_pixel_filter(const PixelFilter& filter, double x_px) {
    const double t = x_px / filter.width_px;  // -0.5 .. 0.5 inside
    if (!(std::abs(t) <= 0.5)) return 0;
    switch (filter.kind) {
        case PixelFilterKind::Box:
            return 1;
        case PixelFilterKind::Gaussian:
            return std::exp(-72.0 * t * t);  // three of Cycles' units to each side
        case PixelFilterKind::BlackmanHarris: {
            const double phase = 2 * std::numbers::pi * (t + 0.5);
            return 0.35875 - 0.48829 * std::cos(phase) + 0.14128 * std::cos(2 * phase) - 0.01168 * std::cos(3 * phase);
        }
    }
    return 0;
}

std::vector<glm::dvec2> make_sample_offsets(const PixelFilter& filter, int sample_count) {
    if (sample_count <= 1) return {glm::dvec2(0.0)};
    const std::vector<double> cumulative = make_cumulative(filter);
    // Half a digit of the radical inverse's last place centres the pattern on the pixel.
    const double shift = 0.5 / std::exp2(std::ceil(std::log2(sample_count)));
    std::vector<glm::dvec2> offsets;
    for (int i = 0; i < sample_count; ++i) {
        const double u = (i + 0.5) / sample_count, v = radical_inverse(unsigned(i)) + shift;
        offsets.emplace_back(invert(cumulative, u, filter.width_px), invert(cumulative, v, filter.width_px));
    }
    return offsets;
}

}  // namespace shadow_layers
