// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The truth's own rule of how receivers stand to a light: by hand, and against the product's rule.
#include "truth/light_rule.h"

#include <gtest/gtest.h>

#include "lights/facing.h"
#include "lights/light_shape.h"
#include "support/ray_oracle.h"
#include "support/technique_scenes.h"

namespace shadow_layers::testing {
namespace {

using truth::LightRule;
using truth::Receiver;
using truth::Standing;
using truth::Standings;

Scene two_groups() {
    Scene scene;
    scene.instances.resize(2);
    scene.instances[1].receiver_group = 1;
    return scene;
}

Receiver receiver_at(glm::dvec3 place, glm::dvec3 normal, std::uint32_t instance = 0) {
    return {{instance, 0}, place, normal, 10, 1e-15, true};
}

constexpr glm::dvec3 kUp(0, 0, 1), kDown(0, 0, -1);

TEST(LightRule, OrderOfTheRules) {
    const Scene scene = two_groups();
    Light light = make_light(LightKind::Spot, {0, 0, 5}, {0, 0, 0}, 60);
    light.receiver_set = 1;
    const LightSample sample = sample_light_shape(light, 1).front();
    const LightRule rule(scene, light, sample);
    EXPECT_EQ(rule.find_standing(receiver_at({0, 0, 0}, kUp)), Standing::Facing);
    EXPECT_EQ(rule.find_standing(receiver_at({0, 0, 0}, kDown)), Standing::TurnedAway);
    EXPECT_EQ(rule.find_standing(receiver_at({9, 0, 0}, kUp)), Standing::Apart);
    EXPECT_EQ(rule.find_standing(receiver_at({9, 0, 0}, kDown)), Standing::Apart);
    EXPECT_EQ(rule.find_standing(receiver_at({0, 0, 0}, kDown, 1)), Standing::Apart);
}

TEST(LightRule, RimsAndGrazingFacesAreTies) {
    const Scene scene = two_groups();
    const Light spot = make_light(LightKind::Spot, {0, 0, 5}, {0, 0, 0}, 60);
    const LightSample sample = sample_light_shape(spot, 1).front();
    const LightRule rule(scene, spot, sample);
    const double rim = 5 * std::tan(glm::radians(30.0));
    const Standings at_rim = rule.find_standings(receiver_at({rim, 0, 0}, kUp));
    EXPECT_TRUE(at_rim.may_be_apart && at_rim.may_be_facing);
    for (const double apart : {-1e-4, 1e-4}) {
        const Standings beside = rule.find_standings(receiver_at({rim + apart, 0, 0}, kUp));
        EXPECT_NE(beside.may_be_apart, beside.may_be_facing);
        EXPECT_EQ(beside.decided, apart < 0 ? Standing::Facing : Standing::Apart);
    }
    const Standings edge_on = rule.find_standings(receiver_at({0, 0, 0}, {1, 0, 0}));
    EXPECT_TRUE(edge_on.may_be_turned_away && edge_on.may_be_facing);
    EXPECT_EQ(edge_on.decided, Standing::TurnedAway);
    const Standings inside = rule.find_standings(receiver_at({0, 0, 5}, kUp));
    EXPECT_TRUE(inside.may_be_turned_away && inside.may_be_facing) << "at the light itself";
}

TEST(LightRule, WeightsAreCosinesAndOfAnAreaLightNearness) {
    const Scene scene = two_groups();
    const Receiver receiver = receiver_at({3, 0, 0}, kUp);
    for (const LightKind kind : {LightKind::Point, LightKind::Area, LightKind::Sun}) {
        const Light light = make_light(kind, {0, 0, 4}, {0, 0, 0});
        const LightSample sample = sample_light_shape(light, 1).front();
        const double weight = LightRule(scene, light, sample).compute_weight(receiver);
        EXPECT_NEAR(weight, kind == LightKind::Sun ? 1 : kind == LightKind::Point ? 0.8 : 0.64 / 25, 1e-12);
    }
}

/// Two rules made apart from each other: certain standings are those that the product finds in float places.
TEST(LightRule, AgreesWithTheProductsRuleButForTies) {
    std::size_t compared = 0, ties = 0, facing = 0, apart = 0, turned = 0;
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area})
        for (unsigned seed = 1; seed <= 3; ++seed) {
            SceneView view = random_scene(seed, 320, 180);
            for (std::size_t i = 0; i < view.scene->instances.size(); ++i)
                view.scene->instances[i].receiver_group = std::uint8_t(i % 4);
            Light light = make_light(kind, {1, 1.5, 1.2}, {0, 0, 0.6}, 50);
            light.radius = 0.2, light.sun_angle = 0.5, light.spot_scale = {0.7 + 0.3 * seed, 1.3};
            light.receiver_set = ~std::uint64_t(4);
            const RayOracle oracle(view.scene);
            const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
            for (const LightSample& sample : sample_light_shape(light, 5, LightPattern::Spiral)) {
                const LightRule rule(*view.scene, light, sample);
                const FacingRule product(frame, light, sample);
                for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
                    const auto receiver = oracle.find_receiver(frame, pixel);
                    ASSERT_EQ(receiver.has_value(), product.classify(pixel) != Facing::Background);
                    if (!receiver) continue;
                    const Standings found = rule.find_standings(*receiver);
                    const Facing facing_there = product.classify(pixel);
                    const Standing its = facing_there == Facing::Undecided    ? Standing::Facing
                                         : facing_there == Facing::TurnedAway ? Standing::TurnedAway
                                                                              : Standing::Apart;
                    ++compared;
                    ties += found.may_be_apart + found.may_be_turned_away + found.may_be_facing > 1;
                    facing += its == Standing::Facing, apart += its == Standing::Apart;
                    turned += its == Standing::TurnedAway;
                    EXPECT_TRUE(its == Standing::Facing       ? found.may_be_facing
                                : its == Standing::TurnedAway ? found.may_be_turned_away
                                                              : found.may_be_apart)
                        << int(kind) << ", pixel " << pixel;
                    if (its != Standing::Facing) continue;
                    // The product's is in units of a light at the shape's centre.
                    const glm::dvec3 apart = glm::dvec3(light.world_from_light[3]) - receiver->place_ws;
                    const double unit = kind == LightKind::Area ? glm::dot(apart, apart) : 1;
                    EXPECT_NEAR(unit * rule.compute_weight(*receiver), product.get_weight(pixel),
                                unit * rule.find_weight_error(*receiver));
                }
            }
        }
    EXPECT_GT(std::min({facing, apart, turned}), 20000u);
    EXPECT_LT(ties, compared / 50000);
}

}  // namespace
}  // namespace shadow_layers::testing
