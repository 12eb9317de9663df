// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace shadow_layers {
namespace {

constexpr PixelFilterKind kKinds[] = {PixelFilterKind::Box, PixelFilterKind::Gaussian, PixelFilterKind::BlackmanHarris};

TEST(PixelFilter, OneSampleIsTheCentre) {
    for (PixelFilterKind kind : kKinds) {
        const auto offsets = make_sample_offsets({kind, 3.0}, 1);
        ASSERT_EQ(offsets.size(), 1u);
        EXPECT_EQ(offsets[0], glm::dvec2(0.0));
    }
}

TEST(PixelFilter, SamplesLieWithinTheWidthAndBalance) {
    for (PixelFilterKind kind : kKinds)
        for (int count : {2, 3, 4, 16, 37, 64}) {
            const auto offsets = make_sample_offsets({kind, 1.5}, count);
            ASSERT_EQ(int(offsets.size()), count);
            glm::dvec2 mean(0.0);
            for (const glm::dvec2& offset : offsets) {
                EXPECT_LE(std::abs(offset.x), 0.75);
                EXPECT_LE(std::abs(offset.y), 0.75);
                mean += offset / double(count);
            }
            EXPECT_NEAR(mean.x, 0, 1e-9);
            EXPECT_NEAR(mean.y, 0, 0.75 / std::sqrt(count));
        }
}

/// The share of samples left of x must follow the filter's integral, found here by another rule (Simpson).
TEST(PixelFilter, SamplesFollowTheFilter) {
    for (PixelFilterKind kind : kKinds) {
        const PixelFilter filter{kind, 2.0};
        const auto integrate = [&](double from, double to) {
            constexpr int kSteps = 2000;
            const double h = (to - from) / kSteps;
            double sum = evaluate_pixel_filter(filter, from) + evaluate_pixel_filter(filter, to);
            for (int i = 1; i < kSteps; ++i) sum += evaluate_pixel_filter(filter, from + i * h) * (i % 2 ? 4 : 2);
            return sum * h / 3;
        };
        const auto offsets = make_sample_offsets(filter, 64);
        const double whole = integrate(-1, 1);
        for (double x : {-0.6, -0.25, 0.0, 0.1, 0.4}) {
            int left_x = 0, left_y = 0;
            for (const glm::dvec2& offset : offsets) left_x += offset.x < x, left_y += offset.y < x;
            const double expected = integrate(-1, x) / whole;
            EXPECT_NEAR(left_x / 64.0, expected, 1.0 / 64);
            EXPECT_NEAR(left_y / 64.0, expected, 1.0 / 64);
        }
    }
}

TEST(PixelFilter, AllSamplesDiffer) {
    const auto offsets = make_sample_offsets({PixelFilterKind::BlackmanHarris, 1.5}, 64);
    for (std::size_t i = 0; i < offsets.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_GT(glm::length(offsets[i] - offsets[j]), 1e-3);
}

}  // namespace
}  // namespace shadow_layers
