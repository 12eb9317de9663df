// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Receivers in tiles: each lit one once, where its light view sees it; and both builds against the rule in double.
#include "visibility/receiver_tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/thread_pool.h"
#include "lights/facing.h"
#include "support/ray_oracle.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

using tile_kernel::ReceiverBlock;
using tile_kernel::ReceiverLanes;

constexpr std::uint32_t kLanes = ReceiverBlock::kLanes;
constexpr LightKind kKinds[] = {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area};

struct Setting {
    SceneView view = make_soup_scene(3, 150, 97);
    Frame frame = RayOracle(view.scene).make_frame(view.camera, view.width, view.height);
    Light light;
    LightSample position;

    explicit Setting(LightKind kind) : light(make_light(kind, {1.5, 1.0, 5.0}, {0, 0, 0.5}, 50)) {
        position = make_light_samples(frame, light, {256, 0, 1}).front();
    }
};

/// Counts how often each pixel is found, and checks what the tiles say of it.
std::vector<int> check_tiles(const Setting& s, ReceiverTiles& tiles, const LightView& view) {
    std::vector<int> found(s.frame.pixel_count());
    for (std::size_t index = 0; index < tiles.tiles.size(); ++index) {
        const tile_kernel::Tile& tile = tiles.tiles[index];
        const glm::dvec2 middle(tiles.middle(int(index % std::size_t(tiles.side))),
                                tiles.middle(int(index / std::size_t(tiles.side))));
        float least = std::numeric_limits<float>::infinity();
        for (std::uint32_t i = 0; i < tile.count; ++i) {
            const ReceiverBlock& block = tiles.blocks[tile.first + i / kLanes];
            const std::uint32_t lane = i % kLanes, pixel = block.pixel[lane];
            ++found.at(pixel);
            const glm::dvec4 lc =
                view.lc_from_ws * glm::dvec4(s.frame.origin_ws + glm::dvec3(s.frame.positions_rel[pixel]), 1);
            EXPECT_NEAR(middle.x + double(block.x[lane]), lc.x / lc.w, 1e-7 * tiles.half_size);
            EXPECT_NEAR(middle.y + double(block.y[lane]), lc.y / lc.w, 1e-7 * tiles.half_size);
            EXPECT_NEAR(block.depth[lane], lc.z / lc.w, 1e-6);
            EXPECT_LE(std::abs(block.x[lane]), float(tiles.half_size) * 1.0001f);
            EXPECT_LE(std::abs(block.y[lane]), float(tiles.half_size) * 1.0001f);
            EXPECT_EQ(block.instance[lane], s.frame.ids[pixel].instance);
            EXPECT_EQ(block.triangle[lane], s.frame.ids[pixel].triangle);
            least = std::min(least, block.depth[lane]);
        }
        if (tile.count > 0) {
            EXPECT_EQ(tile.least_depth, least);
        }
        for (std::uint32_t i = tile.count; i % kLanes != 0; ++i)
            EXPECT_EQ(tiles.blocks[tile.first + i / kLanes].depth[i % kLanes], std::numeric_limits<float>::infinity());
    }
    return found;
}

TEST(ReceiverTiles, HoldEachReceiverThatCastersDecideOnce) {
    for (const LightKind kind : kKinds)
        for (const int threads : {1, 3})
            for (const int most_tiles : {1, 5, 4096}) {
                Setting s(kind);
                ThreadPool pool(threads);
                ReceiverSorter sorter;
                for (int again = 0; again < 2; ++again) sorter.sort(s.frame, s.light, s.position, most_tiles, pool);
                std::vector<int> found(s.frame.pixel_count());
                std::size_t counted = 0;
                for (std::size_t k = 0; k < sorter.views().size(); ++k) {
                    const auto part = check_tiles(s, sorter.views()[k], s.position.views[k]);
                    for (std::size_t pixel = 0; pixel < part.size(); ++pixel) found[pixel] += part[pixel];
                    counted += sorter.views()[k].receiver_count;
                }
                const FacingRule rule(s.frame, s.light, s.position);
                std::size_t lit = 0;
                for (std::size_t pixel = 0; pixel < found.size(); ++pixel) {
                    const Facing facing = rule.classify(pixel);
                    EXPECT_EQ(found[pixel], facing == Facing::Undecided ? 1 : 0) << pixel;
                    EXPECT_EQ(sorter.visible()[pixel], get_unoccluded_visibility(facing) > 0 ? 1 : 0) << pixel;
                    lit += facing == Facing::Undecided;
                }
                EXPECT_EQ(counted, lit);
                EXPECT_GT(lit, 1000u);
            }
}

TEST(ReceiverTiles, BuildsFindTheFacingOfTheRuleBitByBit) {
    for (const LightKind kind : kKinds) {
        const Setting s(kind);
        const FacingRule rule(s.frame, s.light, s.position);
        for (const tile_kernel::Build* build : {&tile_kernel::kBuildBase, &tile_kernel::choose_build()}) {
            for (std::size_t first = 0; first + ReceiverLanes::kCount <= s.frame.pixel_count();
                 first += ReceiverLanes::kCount) {
                ReceiverLanes lanes{};
                std::fill(std::begin(lanes.in_cone), std::end(lanes.in_cone), 1);
                build->find_facing(rule.source(), &s.frame.positions_rel[first].x, &s.frame.normals[first].x, lanes);
                for (int i = 0; i < ReceiverLanes::kCount; ++i) {
                    const std::size_t pixel = first + std::size_t(i);
                    EXPECT_EQ(rule.decide(pixel, lanes.in_cone[i] != 0, lanes.turned_to_light[i] != 0),
                              rule.classify(pixel))
                        << build->name << " " << pixel;
                }
            }
        }
    }
}

}  // namespace
}  // namespace shadow_layers::testing
