// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of sub-pixel shadow maps: sample places and masks, the silhouette mask map, footprints.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "techniques/fsasm/facet.h"
#include "techniques/fsasm/sample_mask.h"
#include "techniques/fsasm/silhouette_mask.h"

namespace shadow_layers {
namespace {

constexpr int kCounts[] = {8, 32, 64, 128};
constexpr SamplePlacement kPlacements[] = {SamplePlacement::Lattice, SamplePlacement::Grid};

/// Part of the unit square about 0 where x cos + y sin + at >= 0.
double compute_half_plane_area(double angle, double at) {
    const double a = std::abs(std::cos(angle)), b = std::abs(std::sin(angle));
    const auto half_square = [](double t) { return t > 0 ? 0.5 * t * t : 0; };
    const double low = at - 0.5 * (a + b);
    return (half_square(low + a + b) - half_square(low + a) - half_square(low + b) + half_square(low)) / (a * b);
}

TEST(SamplePlaces, OneLiesAtTheCentreAndAllInThePixel) {
    for (const SamplePlacement placement : kPlacements)
        for (const int count : kCounts) {
            const SamplePlaces places = make_sample_places(placement, count);
            EXPECT_EQ(places.count, count);
            EXPECT_EQ(places.all().count(), count);
            EXPECT_EQ(places.x[std::size_t(places.centre)], 0);
            EXPECT_EQ(places.y[std::size_t(places.centre)], 0);
            for (std::size_t i = 0; i < std::size_t(count); ++i) {
                EXPECT_LT(std::abs(places.x[i]), 0.5f);
                EXPECT_LT(std::abs(places.y[i]), 0.5f);
                for (std::size_t k = 0; k < i; ++k)
                    EXPECT_GT(std::hypot(places.x[i] - places.x[k], places.y[i] - places.y[k]), 0.4 / count);
            }
        }
}

// What a layer is allowed along straight borders: 1/48 of a pixel with 32 samples, 1/96 with 128.
TEST(SamplePlaces, HalfPlanesAreMeasuredWell) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> part(0, 1);
    for (const SamplePlacement placement : kPlacements)
        for (const auto& [count, bound] : {std::pair{8, 1.0 / 12}, {32, 1.0 / 48}, {64, 1.0 / 72}, {128, 1.0 / 96}}) {
            const SamplePlaces places = make_sample_places(placement, count);
            double error = 0, bias = 0;
            constexpr int kTries = 20000;
            for (int k = 0; k < kTries; ++k) {
                const double angle = 2 * std::numbers::pi * part(random), a = std::cos(angle), b = std::sin(angle);
                const double at = (part(random) - 0.5) * (std::abs(a) + std::abs(b));
                int inside = 0;
                for (std::size_t i = 0; i < std::size_t(count); ++i)
                    inside += a * double(places.x[i]) + b * double(places.y[i]) + at >= 0;
                const double off = double(inside) / count - compute_half_plane_area(angle, at);
                error += std::abs(off);
                bias += off;
            }
            EXPECT_LT(error / kTries, bound) << count;
            EXPECT_LT(std::abs(bias / kTries), 0.1 * bound) << count;
        }
}

TEST(SampleMask, CountsAndCombines) {
    SampleMask a, b;
    EXPECT_TRUE(a.is_empty());
    for (const int bit : {0, 31, 32, 127}) a.set(bit);
    b.set(31), b.set(64);
    EXPECT_EQ(a.count(), 4);
    EXPECT_TRUE(a.has(127));
    EXPECT_FALSE(a.has(64));
    EXPECT_EQ((a & b).count(), 1);
    EXPECT_EQ((a | b).count(), 5);
    EXPECT_EQ(SampleMask(a).remove(b).count(), 3);
}

TEST(HalfPlaneTable, RoundsTheLine) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> part(-1, 1);
    for (const int count : kCounts) {
        const SamplePlaces places = make_sample_places(SamplePlacement::Lattice, count);
        const HalfPlaneTable table(places);
        EXPECT_EQ(table.find(1, 0, 0), places.all());
        EXPECT_TRUE(table.find(-1, 0, 0).is_empty());
        for (int k = 0; k < 2000; ++k) {
            const double by_x = part(random), by_y = part(random), at = part(random), slope = std::hypot(by_x, by_y);
            const SampleMask& mask = table.find(at, by_x, by_y);
            for (std::size_t i = 0; i < std::size_t(count); ++i) {
                const double distance = (at + by_x * double(places.x[i]) + by_y * double(places.y[i])) / slope;
                // Half a step of the angle at the square's corner, and half a step of the offset.
                if (std::abs(distance) > 0.0175) {
                    ASSERT_EQ(mask.has(int(i)), distance > 0);
                }
            }
        }
    }
}

TEST(SilhouetteMask, MarksEveryTexelOnAnEdge) {
    constexpr int kSide = 40;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-4, kSide + 4);
    const std::vector<float> far(kSide * kSide, 0.0f);
    int marked = 0;
    for (int k = 0; k < 400; ++k) {
        MapEdge edge{{place(random), place(random), 0.5f, 1}, {place(random), place(random), 0.5f, 1}};
        if (k % 5 == 0) edge.end.x = edge.start.x;
        if (k % 7 == 0) edge.end.y = edge.start.y;
        const auto texels = mark_silhouette_texels(std::span(&edge, 1), kSide, far);
        for (int step = 0; step <= 4000; ++step) {
            const glm::vec4 p = glm::mix(edge.start, edge.end, float(step) / 4000);
            if (p.x < 0 || p.y < 0 || p.x >= kSide || p.y >= kSide) continue;
            ASSERT_TRUE(texels[std::size_t(int(p.y)) * kSide + std::size_t(int(p.x))]) << k;
        }
        // No texel away from it is marked.
        for (int row = 0; row < kSide; ++row)
            for (int column = 0; column < kSide; ++column) {
                if (!texels[std::size_t(row) * kSide + std::size_t(column)]) continue;
                ++marked;
                const glm::vec2 middle(float(column) + 0.5f, float(row) + 0.5f), a(edge.start), b(edge.end);
                const float length = std::max(glm::dot(b - a, b - a), 1e-12f);
                const float along = glm::clamp(glm::dot(middle - a, b - a) / length, 0.0f, 1.0f);
                ASSERT_LT(glm::length(a + along * (b - a) - middle), 0.72f);
            }
    }
    EXPECT_GT(marked, 4000);
}

TEST(SilhouetteMask, LeavesOutHiddenEdges) {
    constexpr int kSide = 16;
    const MapEdge edge{{2.2f, 8.3f, 0.4f, 1}, {13.7f, 8.6f, 0.4f, 1}};
    std::vector<float> depths(kSide * kSide, 0.6f);  // reversed: a nearer sheet over all
    const auto count = [&] {
        const auto texels = mark_silhouette_texels(std::span(&edge, 1), kSide, depths);
        return SilhouetteMask(kSide, texels).count();
    };
    EXPECT_EQ(count(), 0u);
    depths[7 * kSide + 5] = 0.0f;  // a hole beside the edge
    EXPECT_EQ(count(), 3u);
    std::fill(depths.begin(), depths.end(), 0.4f);  // the edge's own surface
    EXPECT_EQ(count(), 12u);
}

TEST(SilhouetteMask, SumsRectangles) {
    constexpr int kSide = 23;
    std::mt19937 random(8);
    std::vector<std::uint8_t> texels(kSide * kSide);
    for (auto& texel : texels) texel = random() % 3 == 0;
    const SilhouetteMask mask(kSide, texels);
    for (int k = 0; k < 500; ++k) {
        TexelRect rect{int(random() % kSide), 0, int(random() % kSide), 0};
        rect.column_end = rect.column_begin + int(random() % std::uint32_t(kSide - rect.column_begin + 1));
        rect.row_end = rect.row_begin + int(random() % std::uint32_t(kSide - rect.row_begin + 1));
        std::uint32_t expected = 0;
        for (int row = rect.row_begin; row < rect.row_end; ++row)
            for (int column = rect.column_begin; column < rect.column_end; ++column)
                expected += texels[std::size_t(row * kSide + column)];
        ASSERT_EQ(mask.count(rect), expected);
    }
}

// Facets of all kinds, also such as reach behind the light and past the map.
TEST(Footprint, HoldsEveryPlaceOfTheSquare) {
    constexpr int kSide = 64;
    std::mt19937 random(9);
    std::uniform_real_distribution<double> part(-1, 1);
    int held = 0, texels = 0;
    for (int k = 0; k < 3000; ++k) {
        const double size = k % 3 == 0 ? 1.5 : 0.05;
        SquareForm facet;
        facet.at = {part(random), part(random), 0.5, 0.6 + 0.5 * part(random)};
        facet.by_x = size * glm::dvec4(part(random), part(random), 0, part(random));
        facet.by_y = size * glm::dvec4(part(random), part(random), 0, part(random));
        const Footprint footprint(facet, kSide);
        const TexelRect& rect = footprint.rect();
        for (int row = rect.row_begin; row < rect.row_end; ++row) {
            int begin, end;
            footprint.find_columns(row, begin, end);
            texels += end - begin;
        }
        for (int step = 0; step < 21 * 21; ++step) {
            const glm::dvec4 lc = facet.value(step % 21 / 20.0 - 0.5, step / 21 / 20.0 - 0.5);
            if (!(lc.w > 0) || std::abs(lc.x) >= lc.w || std::abs(lc.y) >= lc.w) continue;
            const int column = int((lc.x / lc.w + 1) * 0.5 * kSide), row = int((lc.y / lc.w + 1) * 0.5 * kSide);
            ASSERT_GE(row, rect.row_begin);
            ASSERT_LT(row, rect.row_end);
            int begin, end;
            footprint.find_columns(row, begin, end);
            ASSERT_GE(column, begin);
            ASSERT_LT(column, end);
            ++held;
        }
    }
    EXPECT_GT(held, 100000);
    EXPECT_GT(texels, 10000);
}

}  // namespace
}  // namespace shadow_layers
