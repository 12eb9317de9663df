// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Do the positions of a light spread as Cycles's light does? Moments and projections, of every pattern.
#include "lights/light_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

constexpr int kCount = 1000;
const LightPattern kPatterns[] = {LightPattern::Sequence, LightPattern::Spiral, LightPattern::Grid,
                                  LightPattern::Random};

/// Independent points miss a mean by 1 / sqrt(count), at five times its deviation; even ones by far less.
double tolerance_of(LightPattern pattern) { return pattern == LightPattern::Random ? 0.08 : 0.006; }

Light tilted_light(LightKind kind) { return testing::make_light(kind, {3, -2, 5}, {0.5, 1, 0.3}, 50); }

std::vector<glm::dvec3> offsets_in_light(const Light& light, int count, LightPattern pattern) {
    std::vector<glm::dvec3> offsets;
    for (const LightSample& position : sample_light_shape(light, count, pattern))
        offsets.push_back(glm::dvec3(glm::inverse(light.world_from_light) * glm::dvec4(position.position_ws, 1)));
    return offsets;
}

double mean_of(const std::vector<glm::dvec3>& points, const std::function<double(const glm::dvec3&)>& value) {
    double sum = 0;
    for (const glm::dvec3& point : points) sum += value(point);
    return sum / double(points.size());
}

/// Largest difference between the values' distribution and the even one over [0, 1].
double distance_to_even(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    double most = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        most = std::max(most, std::abs(values[i] - (double(i) + 0.5) / double(values.size())));
    return most;
}

/// Cells of a grid lie on common rings, so that their radii come in steps.
double ring_tolerance_of(LightPattern pattern) {
    return pattern == LightPattern::Grid ? 0.065 : 0.7 * tolerance_of(pattern) + 0.004;
}

TEST(LightShape, ARectangleIsEven) {
    Light light = tilted_light(LightKind::Area);
    light.area_size = {4, 0.5};
    for (const LightPattern pattern : kPatterns) {
        SCOPED_TRACE(int(pattern));
        const auto points = offsets_in_light(light, kCount, pattern);
        const double tolerance = tolerance_of(pattern);
        for (int axis = 0; axis < 2; ++axis) {
            const double size = light.area_size[axis];
            const auto scaled = [&](const glm::dvec3& p) { return p[axis] / size; };
            EXPECT_NEAR(mean_of(points, scaled), 0, tolerance);
            EXPECT_NEAR(mean_of(points, [&](auto& p) { return 12 * scaled(p) * scaled(p); }), 1, 2 * tolerance);
            EXPECT_NEAR(mean_of(points, [&](auto& p) { return 80 * std::pow(scaled(p), 4); }), 1, 4 * tolerance);
        }
        EXPECT_NEAR(mean_of(points, [](auto& p) { return p.x * p.y / 2; }), 0, tolerance);
        for (const glm::dvec3& point : points) EXPECT_NEAR(point.z, 0, 1e-12);
    }
}

TEST(LightShape, AnEllipseIsEven) {
    Light light = tilted_light(LightKind::Area);
    light.area_size = {3, 1};
    light.area_round = true;
    for (const LightPattern pattern : kPatterns) {
        SCOPED_TRACE(int(pattern));
        const auto points = offsets_in_light(light, kCount, pattern);
        std::vector<double> areas;
        for (const glm::dvec3& point : points) areas.push_back(std::pow(2 * point.x / 3, 2) + std::pow(2 * point.y, 2));
        EXPECT_LT(distance_to_even(areas), ring_tolerance_of(pattern));
        EXPECT_NEAR(mean_of(points, [](auto& p) { return p.x; }), 0, 2 * tolerance_of(pattern));
        EXPECT_NEAR(mean_of(points, [](auto& p) { return p.x * p.y; }), 0, 2 * tolerance_of(pattern));
    }
}

// The cosine of a direction that is even in solid angle is even; a sun as wide as half the sky is no small disc.
TEST(LightShape, ASunIsEvenInSolidAngle) {
    for (const double angle : {0.009, 1.0, std::numbers::pi})
        for (const LightPattern pattern : kPatterns) {
            SCOPED_TRACE(int(pattern));
            Light light = tilted_light(LightKind::Sun);
            light.sun_angle = angle;
            const glm::dmat3 light_from_world = glm::transpose(glm::dmat3(light.world_from_light));
            std::vector<double> shares;
            std::vector<glm::dvec3> across;
            for (const LightSample& position : sample_light_shape(light, kCount, pattern)) {
                const glm::dvec3 local = light_from_world * position.to_light_ws;
                EXPECT_NEAR(glm::length(local), 1, 1e-12);
                const double sine = glm::length(glm::dvec2(local));  // 1 - cosine without its rounding
                const double fall = sine * sine / (1 + local.z);
                shares.push_back(fall / (1 - std::cos(0.5 * angle)));
                across.push_back({glm::dvec2(local) / std::sin(0.5 * angle), 0});
                EXPECT_NEAR(glm::dot(position.axes_ws[2], position.to_light_ws), 1, 1e-12);
            }
            EXPECT_LT(distance_to_even(shares), ring_tolerance_of(pattern));
            EXPECT_NEAR(mean_of(across, [](auto& p) { return p.x; }), 0, 2 * tolerance_of(pattern));
            EXPECT_NEAR(mean_of(across, [](auto& p) { return p.y; }), 0, 2 * tolerance_of(pattern));
        }
}

// A bulb is an even disc from wherever it is looked at: the squares of distances from the line of sight are even.
TEST(LightShape, ABulbIsAnEvenDiscFromEverySide) {
    for (const LightKind kind : {LightKind::Point, LightKind::Spot})
        for (const LightPattern pattern : kPatterns) {
            SCOPED_TRACE(int(pattern));
            Light light = tilted_light(kind);
            light.radius = 2;
            const auto points = offsets_in_light(light, kCount, pattern);
            for (const glm::dvec3& side : {glm::dvec3(0, 0, 1), {1, 0, 0}, {0, 1, 0}, {0.6, -0.3, 0.74}, {-1, 1, 1}}) {
                const glm::dvec3 sight = glm::normalize(side);
                std::vector<double> areas;
                for (const glm::dvec3& point : points) {
                    const glm::dvec3 across = point - glm::dot(point, sight) * sight;
                    areas.push_back(glm::dot(across, across) / 4);
                    EXPECT_LE(glm::length(point), 2 + 1e-12);
                }
                EXPECT_LT(distance_to_even(areas), 0.04);
                EXPECT_NEAR(mean_of(points, [&](auto& p) { return glm::dot(p, sight); }), 0, 4 * tolerance_of(pattern));
            }
        }
}

TEST(LightShape, EveryCountGivesEqualShares) {
    Light light = tilted_light(LightKind::Area);
    light.area_size = {1, 1};
    for (int count = 2; count <= 40; ++count)
        for (const LightPattern pattern : {LightPattern::Spiral, LightPattern::Grid}) {
            const auto points = offsets_in_light(light, count, pattern);
            ASSERT_EQ(points.size(), std::size_t(count));
            EXPECT_NEAR(mean_of(points, [](auto& p) { return p.x; }), 0, 0.5 / count + 1e-12) << count;
            for (std::size_t i = 0; i < points.size(); ++i)
                for (std::size_t k = 0; k < i; ++k)
                    EXPECT_GT(glm::distance(points[i], points[k]), 0.35 / std::sqrt(double(count))) << count;
        }
}

TEST(LightShape, WithoutSizeAllPositionsAreTheCentre) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        Light light = tilted_light(kind);
        light.area_size = glm::dvec2(0);
        const LightSample centre = sample_light_shape(light, 1).at(0);
        for (const LightSample& position : sample_light_shape(light, 7, LightPattern::Spiral)) {
            EXPECT_EQ(position.position_ws, centre.position_ws);
            EXPECT_EQ(position.to_light_ws, centre.to_light_ws);
        }
    }
}

}  // namespace
}  // namespace shadow_layers
