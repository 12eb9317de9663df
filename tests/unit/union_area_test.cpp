// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Areas of unions against closed forms, inclusion and exclusion, and counted points.
#include "truth/union_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace shadow_layers::testing {
namespace {

using truth::compute_union_area;
using truth::ConvexPolygon;
using truth::Rectangle;

ConvexPolygon make_polygon(std::initializer_list<glm::dvec2> corners) {
    ConvexPolygon polygon;
    for (const glm::dvec2& corner : corners) polygon.add(corner);
    return polygon;
}

ConvexPolygon make_rectangle(double left, double bottom, double right, double top) {
    return make_polygon({{left, bottom}, {right, bottom}, {right, top}, {left, top}});
}

std::vector<ConvexPolygon> make_random_triangles(unsigned seed, int count, double size, double sliver = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-0.6, 0.6), away(-size, size);
    std::vector<ConvexPolygon> triangles;
    for (int i = 0; i < count; ++i) {
        const glm::dvec2 corner(unit(random), unit(random)), along(away(random), away(random));
        const glm::dvec2 across(-along.y + away(random), along.x + away(random));
        triangles.push_back(make_polygon({corner, corner + along, corner + 0.5 * along + sliver * across}));
    }
    return triangles;
}

/// Whether the point lies in the polygon: on the same side of all its sides.
bool holds(const ConvexPolygon& polygon, const glm::dvec2& point) {
    bool left = true, right = true;
    for (int i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 side = polygon.corner(i + 1) - polygon.corner(i), way = point - polygon.corner(i);
        const double turn = side.x * way.y - side.y * way.x;
        left = left && turn >= 0;
        right = right && turn <= 0;
    }
    return left || right;
}

TEST(UnionArea, RectanglesInClosedForm) {
    EXPECT_EQ(compute_union_area({}, {}), 0);
    const std::vector<ConvexPolygon> cross = {make_rectangle(-2, -0.1, 2, 0.1), make_rectangle(-0.05, -2, 0.05, 2)};
    EXPECT_NEAR(compute_union_area(cross, {}), 0.2 + 0.1 - 0.02, 1e-15);
    const std::vector<ConvexPolygon> apart = {make_rectangle(-0.4, -0.4, -0.2, -0.2), make_rectangle(0.2, 0.1, 0.3, 9),
                                              make_rectangle(3, 3, 4, 4)};
    EXPECT_NEAR(compute_union_area(apart, {}), 0.04 + 0.04, 1e-15);
    EXPECT_EQ(compute_union_area(std::vector{make_rectangle(-1, -1, 1, 1), cross[0]}, {}), 1);
    EXPECT_NEAR(compute_union_area(std::vector(40, cross[0]), {}), 0.2, 1e-14) << "repeated";
}

TEST(UnionArea, PolygonsWithoutAreaCoverNothing) {
    const glm::dvec2 a(-0.3, -0.2), b(0.4, 0.3);
    const std::vector<ConvexPolygon> flat = {make_polygon({a, b}), make_polygon({a, a, a}),
                                             make_polygon({a, 0.5 * (a + b), b}), make_polygon({a}), ConvexPolygon()};
    EXPECT_NEAR(compute_union_area(flat, {}), 0, 1e-16);
    std::vector<ConvexPolygon> both = flat;
    both.push_back(make_rectangle(-0.25, -0.25, 0.25, 0.25));
    EXPECT_NEAR(compute_union_area(both, {}), 0.25, 1e-15);
}

TEST(UnionArea, TilesCoverWhatTheyTile) {
    // A fan about a point, and a grid of triangles that is turned, both over the whole square.
    std::vector<ConvexPolygon> fan, grid;
    for (int i = 0; i < 100; ++i) {
        const auto at = [](int k) {
            return 2.0 * glm::dvec2(std::cos(0.02 * std::numbers::pi * k), std::sin(0.02 * std::numbers::pi * k));
        };
        fan.push_back(make_polygon({{0.113, -0.07}, at(i), at(i + 1)}));
    }
    const auto place = [](int i, int j) { return glm::dvec2(0.17 * i - 0.05 * j, 0.05 * i + 0.17 * j); };
    for (int i = -8; i < 8; ++i) {
        for (int j = -8; j < 8; ++j) {
            grid.push_back(make_polygon({place(i, j), place(i + 1, j), place(i + 1, j + 1)}));
            grid.push_back(make_polygon({place(i, j), place(i + 1, j + 1), place(i, j + 1)}));
        }
    }
    EXPECT_NEAR(compute_union_area(fan, {}), 1, 1e-13);
    EXPECT_NEAR(compute_union_area(grid, {}), 1, 1e-13);
    grid.erase(grid.begin() + 2 * (8 * 16 + 8));  // a triangle about the middle
    EXPECT_NEAR(compute_union_area(grid, {}), 1 - 0.5 * (0.17 * 0.17 + 0.05 * 0.05), 1e-13);
}

TEST(UnionArea, PairsByInclusionAndExclusion) {
    for (unsigned seed = 0; seed < 300; ++seed) {
        const auto pair = make_random_triangles(seed, 2, 0.7, seed % 3 ? 1 : 1e-4);
        // The second, cut by the sides of the first, is what they share.
        ConvexPolygon shared = pair[1];
        const glm::dvec2 middle = (pair[0].corner(0) + pair[0].corner(1) + pair[0].corner(2)) / 3.0;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec2 side = pair[0].corner(i + 1) - pair[0].corner(i);
            glm::dvec2 out(side.y, -side.x);
            if (glm::dot(out, middle - pair[0].corner(i)) > 0) out = -out;
            shared = shared.clip(out, glm::dot(out, pair[0].corner(i)));
        }
        const Rectangle all{glm::dvec2(-4), glm::dvec2(4)};
        EXPECT_NEAR(compute_union_area(pair, all),
                    pair[0].compute_area() + pair[1].compute_area() - shared.compute_area(), 1e-13)
            << seed;
    }
}

TEST(UnionArea, HeapsAreWhatCountedPointsSay) {
    constexpr int kSide = 400;
    for (unsigned seed = 0; seed < 12; ++seed) {
        const int count = seed % 4 == 3 ? 300 : 3 + int(seed);
        const auto heap = make_random_triangles(seed, count, seed % 4 == 3 ? 0.05 : 0.3, seed % 2 ? 1 : 0.05);
        int covered = 0;
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                const glm::dvec2 point((x + 0.5) / kSide - 0.5, (y + 0.5) / kSide - 0.5);
                for (const ConvexPolygon& polygon : heap) {
                    if (!holds(polygon, point)) continue;
                    ++covered;
                    break;
                }
            }
        }
        const double area = compute_union_area(heap, {});
        EXPECT_NEAR(area, double(covered) / (kSide * kSide), 2e-3) << seed;
        EXPECT_GT(area, 0.001);
    }
}

TEST(UnionArea, PartsOfTheSquareAddUp) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const auto heap = make_random_triangles(100 + seed, 5 + 12 * int(seed), 0.2, seed % 2 ? 1 : 1e-3);
        const double cut = -0.4 + 0.04 * seed;
        const Rectangle left{{-0.5, -0.5}, {cut, 0.5}}, right{{cut, -0.5}, {0.5, 0.5}};
        const Rectangle lower{{-0.5, -0.5}, {0.5, cut}}, upper{{-0.5, cut}, {0.5, 0.5}};
        const double whole = compute_union_area(heap, {});
        EXPECT_NEAR(compute_union_area(heap, left) + compute_union_area(heap, right), whole, 1e-12);
        EXPECT_NEAR(compute_union_area(heap, lower) + compute_union_area(heap, upper), whole, 1e-12);
        auto mirrored = heap;
        std::reverse(mirrored.begin(), mirrored.end());
        EXPECT_NEAR(compute_union_area(mirrored, {}), whole, 1e-12);
    }
}

}  // namespace
}  // namespace shadow_layers::testing
