// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Casters are passed over by the tiles that they may touch and by their greatest depth: never one that shadows.
#include "visibility/tile_extent.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace shadow_layers {
namespace {

constexpr int kSide = 6;

struct Receiver {
    glm::dvec2 place;
    double depth;
};

/// The ray of q through the corners' triangle, and the triangle's depth there; by the factors of the corners.
bool is_shadowed(const ClipCorner (&corners)[3], const Receiver& receiver) {
    const glm::dvec3 q(receiver.place, 1), &a = corners[0].xyw, &b = corners[1].xyw, &c = corners[2].xyw;
    const double det = glm::dot(a, glm::cross(b, c));
    if (det == 0) return false;
    const glm::dvec3 factors =
        glm::dvec3(glm::dot(q, glm::cross(b, c)), glm::dot(q, glm::cross(c, a)), glm::dot(q, glm::cross(a, b))) / det;
    if (factors.x < 0 || factors.y < 0 || factors.z < 0) return false;
    return factors.x * corners[0].z + factors.y * corners[1].z + factors.z * corners[2].z >= receiver.depth;
}

/// One receiver in each tile, at random; some tiles are empty.
class Field {
public:
    explicit Field(std::mt19937& random) {
        std::uniform_real_distribution<double> unit(0, 1);
        for (int row = 0; row < kSide; ++row)
            for (int column = 0; column < kSide; ++column) {
                const glm::dvec2 place = (glm::dvec2(column + unit(random), row + unit(random)) * (2.0 / kSide)) - 1.0;
                receivers.push_back({place, double(float(unit(random) * 1.2 - 0.1))});
                tile_kernel::TileContent tile;
                tile.count = unit(random) < 0.8 ? 1 : 0;
                tile.least_depth = float(receivers.back().depth);
                tiles.push_back(tile);
            }
    }
    std::vector<Receiver> receivers;
    std::vector<tile_kernel::TileContent> tiles;
};

TEST(TileExtent, NoCasterThatShadowsAReceiverIsPassedOver) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> across(-1.6, 1.6), depth(0, 1), unit(0, 1);
    std::size_t shadowing = 0, passed_over = 0;
    for (int round = 0; round < 40000; ++round) {
        const Field field(random);
        const CasterGrid grid(kSide, 1e-9, field.tiles.data());
        // Some corners lie behind the light: w < 0. Small triangles and large ones.
        ClipCorner corners[3];
        const glm::dvec2 middle(across(random), across(random));
        const double size = round % 2 ? 0.2 : 1.5, first_depth = depth(random);
        for (ClipCorner& corner : corners) {
            const double w = unit(random) < 0.1 ? -unit(random) : 0.02 + unit(random);
            const glm::dvec2 place = middle + size * glm::dvec2(across(random), across(random));
            corner = {{place * w, w}, (first_depth + 0.2 * across(random)) * w};
        }
        tile_kernel::TileExtent extent;
        const bool touches = find_extent(corners, grid, extent);
        const bool kept = touches && may_meet_receivers(extent, grid, kSide * kSide);
        for (std::size_t index = 0; index < field.receivers.size(); ++index) {
            if (field.tiles[index].count == 0 || !is_shadowed(corners, field.receivers[index])) continue;
            ++shadowing;
            ASSERT_TRUE(kept) << "round " << round;
            const int column = int(index) % kSide, row = int(index) / kSide;
            ASSERT_TRUE(column >= extent.column_begin && column < extent.column_end && row >= extent.row_begin &&
                        row < extent.row_end)
                << "round " << round;
        }
        passed_over += !kept;
    }
    EXPECT_GT(shadowing, 10000u);
    EXPECT_GT(passed_over, 5000u) << "something is passed over at all";
}

}  // namespace
}  // namespace shadow_layers
