// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// All builds of the inner loop against one another and against a loop without SIMD.
#include "visibility/tile_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace shadow_layers::tile_kernel {
namespace {

constexpr std::uint32_t kReceivers = 37, kLanes = ReceiverBlock::kLanes;

/// One tile full of receivers over [-1, 1]^2.
struct OneTile {
    Tile tile;
    std::vector<ReceiverBlock> blocks = std::vector<ReceiverBlock>((kReceivers + kLanes - 1) / kLanes);
    std::vector<std::uint8_t> visible = std::vector<std::uint8_t>(kReceivers + kLanes, 1);
    std::vector<OpenPair> open = std::vector<OpenPair>(5);
    std::vector<std::uint32_t> open_pixels;

    explicit OneTile(unsigned seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> unit(-1, 1);
        tile.count = kReceivers;
        for (std::uint32_t i = 0; i < blocks.size() * kLanes; ++i) {
            x(i) = unit(random), y(i) = unit(random);
            depth(i) = i < kReceivers ? 0.5f + 0.4f * unit(random) : std::numeric_limits<float>::infinity();
            block(i).pixel[i % kLanes] = i;
            block(i).instance[i % kLanes] = 7;
            block(i).triangle[i % kLanes] = i;
        }
    }
    ReceiverBlock& block(std::uint32_t i) { return blocks[i / kLanes]; }
    float& x(std::uint32_t i) { return block(i).x[i % kLanes]; }
    float& y(std::uint32_t i) { return block(i).y[i % kLanes]; }
    float& depth(std::uint32_t i) { return block(i).depth[i % kLanes]; }

    static void settle(void* context, Answers& answers) {
        auto& self = *static_cast<OneTile*>(context);
        for (std::size_t i = 0; i < answers.open_count; ++i) self.open_pixels.push_back(answers.open[i].pixel);
        answers.open_count = 0;
    }
    void draw(const Build& build, const CasterTriangle& triangle) {
        Answers answers{visible.data(), open.data(), 0, open.size(), &OneTile::settle, this, 0};
        build.draw_triangles(&triangle, 1, 0, 1, {1, 1.0, 0.0f, &tile, blocks.data()}, answers);
        settle(this, answers);
    }
};

/// The half-plane x + 0.3 y >= 0, cut by two far edges, with a sloped depth.
CasterTriangle make_triangle(std::uint32_t instance, std::uint32_t number) {
    CasterTriangle t{};
    const double forms[4][3] = {{0.0, 1.0, 0.3}, {9.0, -1.0, 0.2}, {9.0, -0.1, -1.0}, {0.5, 0.1, -0.2}};
    for (int i = 0; i < 4; ++i) t.at[i] = forms[i][0], t.by_x[i] = forms[i][1], t.by_y[i] = forms[i][2];
    t.extent = {0, 1, 0, 1, 1.0};
    t.instance = instance, t.triangle = number;
    return t;
}

std::vector<const Build*> all_builds() {
    std::vector<const Build*> builds = {&kBuildBase};
    if (&choose_build() != &kBuildBase) builds.push_back(&choose_build());
    return builds;
}

TEST(TileKernel, EqualsAPlainLoop) {
    for (const Build* build : all_builds())
        for (unsigned seed = 1; seed < 40; ++seed) {
            OneTile tile(seed);
            OneTile before = tile;
            tile.draw(*build, make_triangle(0, 0));
            std::uint32_t shadowed = 0;
            for (std::uint32_t i = 0; i < kReceivers; ++i) {
                const double x = before.x(i), y = before.y(i);
                const double plane = 0.5 + 0.1 * x - 0.2 * y;
                const bool blocked = x + 0.3 * y >= 0 && plane > before.depth(i);
                if (std::abs(x + 0.3 * y) < 1e-3 || std::abs(plane - before.depth(i)) < 1e-3) continue;
                EXPECT_EQ(tile.visible[i], blocked ? 0 : 1) << seed << " " << i;
                shadowed += blocked;
            }
            EXPECT_GT(shadowed, 0u);
            for (std::uint32_t i = kReceivers; i < tile.visible.size(); ++i) EXPECT_EQ(tile.visible[i], 1) << "padding";
        }
}

TEST(TileKernel, ShadowedReceiversLeaveTheTile) {
    for (const Build* build : all_builds()) {
        OneTile tile(3);
        tile.draw(*build, make_triangle(0, 0));
        std::set<std::uint32_t> left;
        float least = std::numeric_limits<float>::infinity();
        for (std::uint32_t i = 0; i < tile.tile.count; ++i) {
            left.insert(tile.block(i).pixel[i % kLanes]);
            least = std::min(least, tile.depth(i));
        }
        EXPECT_EQ(left.size(), tile.tile.count);
        EXPECT_EQ(tile.tile.least_depth, least);
        EXPECT_EQ(tile.tile.busy, 0u);
        for (std::uint32_t i = 0; i < kReceivers; ++i) EXPECT_EQ(left.contains(i), tile.visible[i] == 1) << i;
    }
}

TEST(TileKernel, PairsNearTheErrorBoundStayOpenAndTheListIsEmptiedWhenFull) {
    for (const Build* build : all_builds()) {
        OneTile tile(5);
        for (std::uint32_t i = 0; i < kReceivers; ++i) {
            tile.x(i) = -0.3f * tile.y(i) + 1e-9f * float(i);  // on the edge, within float's error
            tile.depth(i) = 0.1f;
        }
        tile.draw(*build, make_triangle(0, 0));
        EXPECT_EQ(std::set<std::uint32_t>(tile.open_pixels.begin(), tile.open_pixels.end()).size(), kReceivers);
        EXPECT_EQ(tile.open_pixels.size(), kReceivers) << "each pair once";
        EXPECT_EQ(tile.tile.count, kReceivers);
    }
}

TEST(TileKernel, AReceiverIsNeverInItsOwnTrianglesShadow) {
    for (const Build* build : all_builds()) {
        OneTile tile(6);
        for (std::uint32_t i = 0; i < kReceivers; ++i) tile.depth(i) = 0.1f, tile.x(i) = 0.5f;
        tile.draw(*build, make_triangle(7, 11));
        EXPECT_EQ(tile.visible[11], 1);
        EXPECT_EQ(tile.visible[12], 0);
    }
}

/// A grid of tiles, each with one receiver at random, farther from the light than the casters.
struct Grid {
    static constexpr int kSide = 61;
    std::vector<Tile> tiles = std::vector<Tile>(kSide * kSide);
    std::vector<ReceiverBlock> blocks = std::vector<ReceiverBlock>(kSide * kSide);
    std::vector<glm::dvec2> places;
    std::vector<std::uint8_t> visible = std::vector<std::uint8_t>(kSide * kSide, 1);

    explicit Grid(std::mt19937& random) {
        std::uniform_real_distribution<float> unit(-1.0f / kSide, 1.0f / kSide);
        for (std::uint32_t i = 0; i < tiles.size(); ++i) {
            tiles[i].first = i, tiles[i].count = 1;
            std::fill(std::begin(blocks[i].depth), std::end(blocks[i].depth), std::numeric_limits<float>::infinity());
            blocks[i].x[0] = unit(random), blocks[i].y[0] = unit(random), blocks[i].depth[0] = 0;
            blocks[i].pixel[0] = i;
            const glm::dvec2 middle((2 * (i % kSide) + 1.0) / kSide - 1, (2 * (i / kSide) + 1.0) / kSide - 1);
            places.push_back(middle + glm::dvec2(blocks[i].x[0], blocks[i].y[0]));
        }
    }
    static void settle(void*, Answers& answers) { answers.open_count = 0; }
    void draw(const Build& build, const CasterTriangle& triangle) {
        OpenPair open[8];
        Answers answers{visible.data(), open, 0, 8, &Grid::settle, nullptr, 0};
        build.draw_triangles(&triangle, 1, 0, kSide, {kSide, 1.0 / kSide, 0.0f, tiles.data(), blocks.data()}, answers);
    }
};

double compute_side(const glm::dvec2& p, const glm::dvec2& q, const glm::dvec2& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

/// A level triangle with these corners, counter-clockwise, over all tiles.
CasterTriangle make_level(const glm::dvec2 (&c)[3]) {
    CasterTriangle t{};
    for (int i = 0; i < 3; ++i) {
        const glm::dvec2 &p = c[(i + 1) % 3], &q = c[(i + 2) % 3];
        t.at[i] = p.x * q.y - p.y * q.x, t.by_x[i] = p.y - q.y, t.by_y[i] = q.x - p.x;
    }
    t.at[3] = 0.5;
    t.extent = {0, Grid::kSide, 0, Grid::kSide, 0.5};
    t.instance = 1;  // no receiver is on it
    return t;
}

TEST(TileKernel, WideTrianglesMissNoTile) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::size_t shadowed = 0;
    for (int k = 0; k < 300; ++k) {
        // A third each: anyhow, needles, and needles along an axis, some of them far larger than the map.
        const double reach = k % 5 == 0 ? 50 : 1.5, width = k % 3 == 0 ? 1 : 0.03;
        glm::dvec2 c[3];
        c[0] = reach * glm::dvec2(unit(random), unit(random));
        c[1] = k % 3 == 2 ? c[0] + glm::dvec2(reach * unit(random), 0) : reach * glm::dvec2(unit(random), unit(random));
        c[2] = c[k % 2] + width * reach * glm::dvec2(unit(random), unit(random));
        if (compute_side(c[0], c[1], c[2]) < 0) std::swap(c[1], c[2]);
        for (const Build* build : all_builds()) {
            Grid grid(random);
            grid.draw(*build, make_level(c));
            for (std::size_t i = 0; i < grid.places.size(); ++i) {
                double least = std::numeric_limits<double>::infinity();
                for (int e = 0; e < 3; ++e) {
                    const glm::dvec2 &p = c[(e + 1) % 3], &q = c[(e + 2) % 3];
                    least = std::min(least, compute_side(p, q, grid.places[i]) / glm::length(q - p));
                }
                if (std::abs(least) < 1e-4 * reach) continue;
                ASSERT_EQ(grid.visible[i], least > 0 ? 0 : 1) << "triangle " << k << ", tile " << i;
                shadowed += least > 0;
            }
        }
    }
    EXPECT_GT(shadowed, 20000u);
}

}  // namespace
}  // namespace shadow_layers::tile_kernel
