// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Lines and triangles against a solution in long double, and where rounding can't tell.
#include "truth/sight_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace shadow_layers::testing {
namespace {

using truth::Corners;
using truth::cross_triangle;
using truth::Crossing;
using truth::find_neighbourhood;
using truth::SightLine;

/// Distance along the line and the least barycentric coordinate, by Cramer's rule; distance 0 where there is no plane.
struct Solution {
    long double distance = 0, least = 0;
};

Solution solve(const SightLine& line, const Corners& corners) {
    using V = glm::tvec3<long double>;
    const V a(corners[0]), e = V(corners[1]) - a, f = V(corners[2]) - a, way(line.way), p = glm::cross(way, f);
    const long double det = glm::dot(e, p);
    if (det == 0) return {};
    const V s = V(line.start) - a, q = glm::cross(s, e);
    const long double u = glm::dot(s, p) / det, v = glm::dot(way, q) / det;
    return {glm::dot(f, q) / det, std::min({u, v, 1 - u - v})};
}

TEST(SightLine, CertainAnswersAreThoseOfLongDouble) {
    std::mt19937 random(7);
    std::normal_distribution<double> value(0, 1);
    const auto point = [&](double reach) { return reach * glm::dvec3(value(random), value(random), value(random)); };
    int met = 0, missed = 0, uncertain = 0;
    for (int i = 0; i < 300000; ++i) {
        const double size = std::pow(10.0, -4.0 * (i % 7) / 6.0);
        const glm::dvec3 middle = point(1);
        const Corners corners{middle + point(size), middle + point(size), middle + point(size)};
        SightLine line{point(2), {}, i % 3 == 0, 1e-15};
        // Through the triangle, beside it, or through an edge itself.
        std::uniform_real_distribution<double> side(i % 2 == 0 ? 0 : -2, i % 2 == 0 ? 0.5 : 2);
        const double u = i % 11 == 0 ? 0.5 : side(random), v = i % 11 == 0 ? 0 : side(random);
        const glm::dvec3 target = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
        line.way = (target - line.start) * (i % 5 == 0 ? 0.9 : 1.1);
        const Crossing crossing = cross_triangle(line, corners);
        EXPECT_FALSE(i % 11 == 0 && crossing.certain && crossing.meets) << "an edge's rim is a tie";
        if (!crossing.certain) {
            ++uncertain;
            continue;
        }
        const Solution exact = solve(line, corners);
        const bool meets = exact.least >= 0 && exact.distance > 0 && (line.endless || exact.distance < 1);
        EXPECT_EQ(crossing.meets, meets) << i;
        ++(meets ? met : missed);
        const double rounding = 1e-9 * std::abs(crossing.distance) + 1e-12;
        EXPECT_TRUE(!meets || std::abs(crossing.distance - double(exact.distance)) <= rounding) << i;
    }
    EXPECT_GT(met, 30000);
    EXPECT_GT(missed, 50000);
    EXPECT_LT(uncertain, 300000 / 11 + 300);
}

// A program whose places are off by less than the slack finds no other answer.
TEST(SightLine, CertainAnswersStayWithinTheSlack) {
    std::mt19937 random(8);
    std::normal_distribution<double> value(0, 1);
    std::uniform_real_distribution<double> part(-0.55, 0.55);
    const auto point = [&] { return glm::dvec3(value(random), value(random), value(random)); };
    int checked = 0;
    for (int i = 0; i < 100000; ++i) {
        const double slack = 1e-3;
        Corners corners{point(), point(), point()};
        SightLine line{2.0 * point(), point(), i % 2 == 0, slack};
        const Crossing crossing = cross_triangle(line, corners);
        if (!crossing.certain) continue;
        ++checked;
        const auto shift = [&] { return slack * glm::dvec3(part(random), part(random), part(random)); };
        const glm::dvec3 end = line.start + line.way + shift();
        const bool endless = line.endless;
        line.start += shift();
        if (!endless) line.way = end - line.start;
        for (glm::dvec3& corner : corners) corner += shift();
        line.slack = 0;
        EXPECT_EQ(cross_triangle(line, corners).meets, crossing.meets) << i;
    }
    EXPECT_GT(checked, 80000);
}

TEST(SightLine, EndsAndEdgeOnTrianglesAreTies) {
    const Corners flat{glm::dvec3(-1, -1, 0), {1, -1, 0}, {0, 1, 0}};
    const auto cross = [&](glm::dvec3 start, glm::dvec3 end, bool endless = false) {
        return cross_triangle({start, end - start, endless, 1e-15}, flat);
    };
    EXPECT_TRUE(cross({0, 0, 1}, {0, 0, -1}).meets);
    EXPECT_TRUE(cross({0, 0, 1}, {0, 0, -1}).certain);
    for (const Crossing& tie : {cross({0, 0, 0}, {0, 0, 1}), cross({0, 0, 1}, {0, 0, 0}), cross({-3, 0, 0}, {3, 0, 0}),
                                cross({0, 1, 1}, {0, 1, -1})})
        EXPECT_FALSE(tie.certain);
    for (const Crossing& miss :
         {cross({0, 0, 1e-6}, {0, 0, 1}), cross({0, 0, 1}, {0, 0, 1e-6}), cross({0, 1 + 1e-9, 1}, {0, 1 + 1e-9, -1})}) {
        EXPECT_FALSE(miss.meets);
        EXPECT_TRUE(miss.certain);
    }
    EXPECT_TRUE(cross({0, 0, 1}, {0, 0, 0.5}, true).meets) << "without an end";
    EXPECT_FALSE(cross({0, 0, 1}, {0, 0, 0.5}).meets);
}

TEST(SightLine, NoLineSlipsThroughAnEdge) {
    std::mt19937 random(9);
    std::normal_distribution<double> value(0, 1);
    const auto point = [&] { return glm::dvec3(value(random), value(random), value(random)); };
    for (int i = 0; i < 100000; ++i) {
        // Two triangles on two sides of an edge, and a line through a place of the edge.
        const glm::dvec3 p = point(), q = point(), aside = point(), start = 3.0 * point();
        const glm::dvec3 through = p + (0.1 + 0.8 * double(i % 97) / 97) * (q - p);
        const SightLine line{start, 2.0 * (through - start), false, 0};
        const bool met = cross_triangle(line, {p, q, p + aside}).meets || cross_triangle(line, {q, p, q - aside}).meets;
        EXPECT_TRUE(met) << i;
    }
}

TEST(SightLine, NeighboursInThePlaneAreTheReceiversOwnSurface) {
    const Corners self{glm::dvec3(0, 0, 0), {1, 0, 0}, {0, 1, 0}};
    const auto with_apex = [&](double height) {
        return find_neighbourhood(self, {glm::dvec3(1, 0, 0), {1, 1, height}, {0, 1, 0}}, 1e-15);
    };
    EXPECT_TRUE(with_apex(0).is_own_surface && with_apex(0).certain);
    EXPECT_TRUE(with_apex(9e-7).is_own_surface && with_apex(9e-7).certain);
    EXPECT_FALSE(with_apex(1.2e-6).certain) << "the tolerance itself";
    EXPECT_TRUE(!with_apex(2e-6).is_own_surface && with_apex(2e-6).certain);
    EXPECT_FALSE(find_neighbourhood(self, {glm::dvec3(1, 0, 0), {2, 1, 0}, {2, 0, 0}}, 1e-15).is_own_surface)
        << "one corner in common";
    EXPECT_TRUE(find_neighbourhood(self, {self[2], self[0], self[1]}, 1e-15).is_own_surface) << "the same triangle";
    const auto near = find_neighbourhood(self, {glm::dvec3(1, 1e-16, 0), {1, 1, 0}, {0, 1, 0}}, 1e-15);
    EXPECT_FALSE(near.certain) << "a corner that another program may not find in common";
}

}  // namespace
}  // namespace shadow_layers::testing
