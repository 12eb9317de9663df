// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// All builds of the inner loop against one another and against a loop without SIMD.
#include "stages/tile_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

namespace shadow_layers::tile_kernel {
namespace {

constexpr std::uint32_t kReceivers = 37;

/// One tile full of receivers over [-1, 1]^2.
struct OneTile {
    std::vector<std::uint32_t> first{0}, count{kReceivers}, pixel, ids;
    std::vector<float> least_depth{0.0f}, zero{0.0f}, x, y, depth;
    std::vector<std::uint8_t> visible;
    std::vector<OpenPair> open = std::vector<OpenPair>(5);
    std::vector<std::uint32_t> open_pixels;

    explicit OneTile(unsigned seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> unit(-1, 1);
        for (std::uint32_t i = 0; i < kReceivers + 32; ++i) {
            x.push_back(unit(random));
            y.push_back(unit(random));
            depth.push_back(0.5f + 0.4f * unit(random));
            pixel.push_back(i);
            visible.push_back(1);
            ids.insert(ids.end(), {7, i});
        }
    }
    static void settle(void* context, Answers& answers) {
        auto& self = *static_cast<OneTile*>(context);
        for (std::size_t i = 0; i < answers.open_count; ++i) self.open_pixels.push_back(answers.open[i].pixel);
        answers.open_count = 0;
    }
    void draw(DrawTriangles draw_triangles, const CasterTriangle& triangle) {
        Tiles tiles{1,           1.0,      first.data(), count.data(), least_depth.data(), zero.data(),
                    zero.data(), x.data(), y.data(),     depth.data(), pixel.data()};
        Answers answers{visible.data(), ids.data(), open.data(), 0, open.size(), &OneTile::settle, this, 0};
        const std::uint32_t order = 0;
        draw_triangles(&triangle, &order, 1, 0, 1, tiles, answers);
        settle(this, answers);
    }
};

/// The half-plane x + 0.3 y >= 0, cut by two far edges, with a sloped depth.
CasterTriangle make_triangle(std::uint32_t instance, std::uint32_t number) {
    CasterTriangle t{};
    t.edges[0] = {0.0, 1.0, 0.3};
    t.edges[1] = {9.0, -1.0, 0.2};
    t.edges[2] = {9.0, -0.1, -1.0};
    t.depth = {0.5, 0.1, -0.2};
    t.greatest_depth = 1;
    t.instance = instance, t.triangle = number;
    t.column_end = t.row_end = 1;
    return t;
}

std::vector<DrawTriangles> all_builds() {
    std::vector<DrawTriangles> builds = {draw_triangles_base};
    if (choose_draw_triangles() != draw_triangles_base) builds.push_back(choose_draw_triangles());
    return builds;
}

TEST(TileKernel, EqualsAPlainLoop) {
    for (const DrawTriangles draw : all_builds())
        for (unsigned seed = 1; seed < 40; ++seed) {
            OneTile tile(seed);
            const OneTile before = tile;
            tile.draw(draw, make_triangle(0, 0));
            std::uint32_t shadowed = 0;
            for (std::uint32_t i = 0; i < kReceivers; ++i) {
                const double x = before.x[i], y = before.y[i];
                const double plane = 0.5 + 0.1 * x - 0.2 * y;
                const bool blocked = x + 0.3 * y >= 0 && plane > before.depth[i];
                if (std::abs(x + 0.3 * y) < 1e-3 || std::abs(plane - before.depth[i]) < 1e-3) continue;
                EXPECT_EQ(tile.visible[i], blocked ? 0 : 1) << seed << " " << i;
                shadowed += blocked;
            }
            EXPECT_GT(shadowed, 0u);
            for (std::uint32_t i = kReceivers; i < kReceivers + 32; ++i) EXPECT_EQ(tile.visible[i], 1) << "padding";
        }
}

TEST(TileKernel, ShadowedReceiversLeaveTheTile) {
    for (const DrawTriangles draw : all_builds()) {
        OneTile tile(3);
        tile.draw(draw, make_triangle(0, 0));
        std::set<std::uint32_t> left(tile.pixel.begin(), tile.pixel.begin() + tile.count[0]);
        EXPECT_EQ(left.size(), tile.count[0]);
        for (std::uint32_t i = 0; i < kReceivers; ++i) EXPECT_EQ(left.contains(i), tile.visible[i] == 1) << i;
    }
}

TEST(TileKernel, PairsNearTheErrorBoundStayOpenAndTheListIsEmptiedWhenFull) {
    for (const DrawTriangles draw : all_builds()) {
        OneTile tile(5);
        for (std::uint32_t i = 0; i < kReceivers; ++i) {
            tile.x[i] = -0.3f * tile.y[i] + 1e-9f * float(i);  // on the edge, within float's error
            tile.depth[i] = 0.1f;
        }
        tile.draw(draw, make_triangle(0, 0));
        EXPECT_EQ(std::set<std::uint32_t>(tile.open_pixels.begin(), tile.open_pixels.end()).size(), kReceivers);
        EXPECT_EQ(tile.open_pixels.size(), kReceivers) << "each pair once";
        EXPECT_EQ(tile.count[0], kReceivers);
    }
}

TEST(TileKernel, AReceiverIsNeverInItsOwnTrianglesShadow) {
    for (const DrawTriangles draw : all_builds()) {
        OneTile tile(6);
        for (float& depth : tile.depth) depth = 0.1f;
        for (float& x : tile.x) x = 0.5f;
        tile.draw(draw, make_triangle(7, 11));
        EXPECT_EQ(tile.visible[11], 1);
        EXPECT_EQ(tile.visible[12], 0);
    }
}

}  // namespace
}  // namespace shadow_layers::tile_kernel
