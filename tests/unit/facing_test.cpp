// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/facing.h"

#include <gtest/gtest.h>

#include <numbers>

#include "base/thread_pool.h"
#include "lights/light_shape.h"
#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

/// One pixel each: the receiver at (x, y, 0) with a normal, in receiver group 0 or 1.
struct Receiver {
    glm::vec3 place, normal;
    std::uint32_t instance = 0;
    bool covered = true;
};

Frame frame_of(const std::vector<Receiver>& receivers) {
    auto scene = std::make_shared<Scene>();
    scene->meshes.push_back(testing::to_mesh("plane", testing::make_plane(1)));
    scene->instances.resize(2);
    scene->instances[1].receiver_group = 1;
    Frame frame;
    frame.width = int(receivers.size()), frame.height = 1;
    frame.origin_ws = {10, 20, 30};
    frame.scene = scene;
    for (const Receiver& r : receivers) {
        frame.positions_rel.push_back(r.place - glm::vec3(frame.origin_ws));
        frame.normals.push_back(r.normal);
        frame.ids.push_back({r.instance, 0});
        frame.coverage.push_back(r.covered);
    }
    return frame;
}

const glm::vec3 kUp(0, 0, 1), kDown(0, 0, -1);

TEST(Facing, OrderOfTheRules) {
    Frame frame = frame_of({{{0, 0, 0}, kUp},            // below the spot
                            {{0, 0, 0}, kDown},          // turned away, in the cone
                            {{9, 0, 0}, kUp},            // outside the cone
                            {{9, 0, 0}, kDown},          // outside and turned away: outside wins
                            {{0, 0, 0}, kDown, 1},       // not linked and turned away: not linked wins
                            {{9, 0, 0}, kDown, 1},       // outside and not linked
                            {{0, 0, 0}, kUp, 0, false},  // a holdout
                            {{0, 0, 0}, {1, 0, 0}},      // edge-on
                            {{0, 0, 5}, kUp}});          // at the light itself
    frame.ids.push_back({});                             // background
    frame.positions_rel.emplace_back(0), frame.normals.emplace_back(0), frame.coverage.push_back(0), ++frame.width;
    Light light = testing::make_light(LightKind::Spot, {0, 0, 5}, {0, 0, 0}, 60);
    light.receiver_set = 1;
    const auto positions = sample_light_shape(light, 1);
    const FacingRule rule(frame, light, positions[0]);
    const Facing expected[] = {Facing::Undecided, Facing::TurnedAway,  Facing::OutsideCone, Facing::OutsideCone,
                               Facing::Unlinked,  Facing::OutsideCone, Facing::Background,  Facing::TurnedAway};
    for (std::size_t i = 0; i < std::size(expected); ++i) EXPECT_EQ(rule.classify(i), expected[i]) << "pixel " << i;
    EXPECT_EQ(rule.classify(9), Facing::Background);

    std::vector<float> visibility(frame.pixel_count());
    fill_unoccluded_visibility(frame, light, positions, visibility);
    EXPECT_EQ(std::vector<float>(visibility.begin(), visibility.begin() + 8),
              (std::vector<float>{1, 0, 1, 1, 1, 1, 1, 0}));
    EXPECT_EQ(visibility[9], 1);
}

TEST(Facing, ConeRimIsWhereTheAngleSays) {
    for (const double angle_deg : {0.5, 20.0, 60.0, 120.0, 179.0}) {
        const double reach = 5 * std::tan(glm::radians(angle_deg / 2));
        const Frame frame = frame_of({{glm::vec3(0.999 * reach, 0, 0), kUp}, {glm::vec3(1.001 * reach, 0, 0), kUp}});
        const Light light = testing::make_light(LightKind::Spot, {0, 0, 5}, {0, 0, 0}, angle_deg);
        const auto positions = sample_light_shape(light, 1);
        const FacingRule rule(frame, light, positions[0]);
        EXPECT_EQ(rule.classify(0), Facing::Undecided) << angle_deg;
        EXPECT_EQ(rule.classify(1), Facing::OutsideCone) << angle_deg;
    }
}

TEST(Facing, ConeFollowsTheSpotsScale) {
    Light light = testing::make_light(LightKind::Spot, {0, 0, 5}, {0, 0, 0}, 60);
    light.spot_scale = {2.0, 0.5};
    const glm::dmat3 axes(light.world_from_light);
    const double reach = 5 * std::tan(glm::radians(30.0));
    const auto positions = sample_light_shape(light, 1);
    for (const double turn : {0.0, 0.4, 1.0, 1.6, 2.5})  // round the ellipse that the cone cuts from the ground
        for (const auto& [part, expected] : {std::pair(0.999, Facing::Undecided), {1.001, Facing::OutsideCone}}) {
            const glm::dvec3 place = part * reach * (2.0 * std::cos(turn) * axes[0] + 0.5 * std::sin(turn) * axes[1]);
            const Frame frame = frame_of({{glm::vec3(place), kUp}});
            EXPECT_EQ(FacingRule(frame, light, positions[0]).classify(0), expected) << turn << " " << part;
        }
    EXPECT_NEAR(find_widest_spot_angle(light), 2 * std::atan(2 * std::tan(glm::radians(30.0))), 1e-12);
}

TEST(Facing, SunPointAndAreaLights) {
    const Frame frame = frame_of({{{3, 0, 0}, kUp}, {{3, 0, 0}, kDown}, {{3, 0, 6}, kDown}, {{-40, 2, 0}, kUp}});
    const auto facing = [&](const Light& light, std::size_t pixel) {
        const auto positions = sample_light_shape(light, 1);
        return FacingRule(frame, light, positions[0]).classify(pixel);
    };
    const Light sun = testing::make_light(LightKind::Sun, {0, 0, 5}, {1, 0, 0});
    EXPECT_EQ(facing(sun, 0), Facing::Undecided);
    EXPECT_EQ(facing(sun, 1), Facing::TurnedAway);
    EXPECT_EQ(facing(sun, 3), Facing::Undecided);  // where a sun stands does not matter
    const Light point = testing::make_light(LightKind::Point, {0, 0, 5}, {1, 0, 9});
    EXPECT_EQ(facing(point, 0), Facing::Undecided);
    EXPECT_EQ(facing(point, 2), Facing::Undecided);  // above the light, looking down at it
    const Light area = testing::make_light(LightKind::Area, {0, 0, 5}, {0, 0, 0});
    EXPECT_EQ(facing(area, 0), Facing::Undecided);
    EXPECT_EQ(facing(area, 1), Facing::TurnedAway);
    EXPECT_EQ(facing(area, 2), Facing::OutsideCone);  // behind the area
}

TEST(LightShape, ManyPositionsSpreadOverTheShape) {
    Light light = testing::make_light(LightKind::Area, {1, 2, 3}, {1, 2, 0});
    light.area_size = {4, 2};
    glm::dvec3 mean(0);
    double widest = 0;
    const auto area = sample_light_shape(light, 200);
    for (const LightSample& p : area) {
        const glm::dvec3 local = glm::inverse(light.world_from_light) * glm::dvec4(p.position_ws, 1);
        EXPECT_LE(std::abs(local.x), 2 + 1e-12);
        EXPECT_LE(std::abs(local.y), 1 + 1e-12);
        EXPECT_NEAR(local.z, 0, 1e-12);
        mean += local / 200.0;
        widest = std::max(widest, std::abs(local.x));
    }
    EXPECT_LT(glm::length(mean), 0.05);
    EXPECT_GT(widest, 1.9);

    light = testing::make_light(LightKind::Sun, {0, 0, 1}, {0, 0, 0});
    light.sun_angle = 0.1;
    double most = 0;
    for (const LightSample& p : sample_light_shape(light, 100)) {
        EXPECT_NEAR(glm::length(p.to_light_ws), 1, 1e-12);
        const double angle = std::acos(p.to_light_ws.z);
        EXPECT_LE(angle, 0.05 + 1e-9);
        most = std::max(most, angle);
    }
    EXPECT_GT(most, 0.045);

    light = testing::make_light(LightKind::Point, {5, 6, 7}, {0, 0, 0});
    light.radius = 2;
    for (const LightSample& p : sample_light_shape(light, 50))
        EXPECT_LE(glm::distance(p.position_ws, {5, 6, 7}), 2 + 1e-12);
    EXPECT_EQ(sample_light_shape(light, 1)[0].position_ws, glm::dvec3(light.world_from_light[3]));
}

TEST(Facing, WhatAPartOfTheLightShinesOnIsInNoShadow) {
    const Frame frame = frame_of({{{0, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {0, 0, -1}}});
    Light light = testing::make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0});
    light.sun_angle = 0.2;
    std::vector<float> visibility(3);
    fill_unoccluded_visibility(frame, light, sample_light_shape(light, 16), visibility);
    EXPECT_EQ(visibility, (std::vector<float>{1, 1, 0}));  // the wall sees half of the sun
}

TEST(Facing, ThreadsDoNotChangeTheResult) {
    std::vector<Receiver> receivers;
    for (int i = 0; i < 100000; ++i)
        receivers.push_back({glm::vec3(i % 317 * 0.1f - 15, i % 211 * 0.1f - 10, 0), glm::vec3(0, 0, i % 3 ? 1 : -1)});
    const Frame frame = frame_of(receivers);
    Light light = testing::make_light(LightKind::Spot, {0, 0, 5}, {0, 0, 0}, 60);
    const auto positions = sample_light_shape(light, 3);
    std::vector<float> one(frame.pixel_count()), many(frame.pixel_count());
    ThreadPool threads(3);
    fill_unoccluded_visibility(frame, light, positions, one);
    fill_unoccluded_visibility(frame, light, positions, many, &threads);
    EXPECT_EQ(one, many);
}

}  // namespace
}  // namespace shadow_layers
