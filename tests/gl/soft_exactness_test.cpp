// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// soft against what defines it: rays in double to the same samples, with and without a tree; the hard technique at one
// sample; the weighted mean of hard layers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "lights/sample_pattern.h"
#include "support/ray_comparison.h"
#include "support/soft_comparison.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

/// `size`: the light's diameter as a part of its distance to the scene.
Light make_soft_light(LightKind kind, double size, const glm::dvec3& place = {1.6, 1.2, 4.2}) {
    Light light = make_light(kind, place, {0, 0, 0.4}, 80);
    const double distance = glm::length(place - glm::dvec3(0, 0, 0.4));
    light.radius = 0.5 * size * distance;
    light.sun_angle = 2 * std::atan(0.5 * size);
    light.area_size = glm::dvec2(1, 0.6) * size * distance;
    light.area_round = kind == LightKind::Area && size < 0.2;
    return light;
}

class SoftExactness : public ::testing::Test {
protected:
    void expect_exact(const SceneView& view, const Light& light, int samples, const std::string& what,
                      std::size_t least = 100) {
        const SoftComparison found = compare_soft(runner_, view, light, samples);
        EXPECT_EQ(found.wrong, 0u) << what << ", kind " << int(light.kind) << ", " << samples << " samples";
        EXPECT_LE(found.ties, 2 + found.bits / 20000) << what;
        EXPECT_GE(found.penumbra, least) << what << ", kind " << int(light.kind);
        bits_ += found.bits;
    }
    std::vector<float> render(const SceneView& view, const char* technique, ParameterValues values) {
        return runner_.render(view, technique, values).visibility();
    }
    TechniqueRunner runner_;
    std::size_t bits_ = 0;
};

/// All triangles are tried on every line: no tree of anybody's takes part.
TEST_F(SoftExactness, EqualsEveryTriangleTriedOnEveryLine) {
    std::size_t decisions = 0, penumbra = 0, wrong = 0;
    for (const LightKind kind : kAllLightKinds) {
        SceneView view = make_soup_scene(20 + unsigned(kind), 64, 36, 60);
        const Light light = make_soft_light(kind, 0.3);
        view.scene->lights = {light};
        const TechniqueRun run = runner_.render(view, "soft", parameters({{"light_samples", std::int64_t{16}}}));
        const truth::RayOracle oracle(view.scene);
        const auto samples = sample_light_shape(light, 16, LightPattern::Spiral);
        for (std::size_t pixel = 0; pixel < run.frame->pixel_count(); ++pixel) {
            const auto receiver = oracle.find_receiver(*run.frame, pixel);
            if (!receiver) continue;
            double all = 0, least = 0, most = 0;
            for (const LightSample& sample : samples) {
                const truth::LightRule rule(*view.scene, light, sample);
                const truth::Standings standings = rule.find_standings(*receiver);
                if (!standings.may_be_facing) continue;
                const glm::dvec3 start = receiver->place_ws - oracle.get_origin();
                truth::SightLine line{start, 50.0 * sample.to_light_ws, sample.directional, 1e-14};
                if (!sample.directional) line.way = sample.position_ws - receiver->place_ws;
                bool blocked = false, certain = !standings.may_be_apart && !standings.may_be_turned_away;
                for (std::uint32_t k = 0; k < view.scene->instances.size(); ++k)
                    for (std::uint32_t t = 0; t < view.scene->meshes[k]->triangles.size(); ++t) {
                        if (k == receiver->ids.instance && t == receiver->ids.triangle) continue;
                        const auto corners = oracle.get_corners({k, t});
                        const truth::Crossing crossing = truth::cross_triangle(line, corners);
                        ++decisions;
                        if (crossing.certain && !crossing.meets) continue;
                        if (truth::find_neighbourhood(oracle.get_corners(receiver->ids), corners, 1e-14).is_own_surface)
                            continue;
                        certain = certain && crossing.certain;
                        blocked = blocked || crossing.meets;
                    }
                const double weight = std::max(0.0, rule.compute_weight(*receiver));
                all += weight;
                if (!blocked || !certain) most += weight;
                if (!blocked && certain) least += weight;
            }
            if (!(all > 0)) continue;
            const double value = double(run.visibility()[pixel]);
            wrong += value < least / all - 1e-4 || value > most / all + 1e-4;
            penumbra += value > 0 && value < 1;
        }
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(penumbra, 1000u);
    EXPECT_GT(decisions, 1000000u);
}

TEST_F(SoftExactness, EqualsRaysUnderLightsOfAllSizes) {
    for (const LightKind kind : kAllLightKinds)
        for (const double size : {1e-3, 0.05, 0.3, 1.5}) {
            expect_exact(make_soup_scene(4 + unsigned(kind), 160, 90), make_soft_light(kind, size), 64, "soup",
                         size < 0.01 ? 3 : 100);
            expect_exact(random_scene(4 + unsigned(kind), 160, 90), make_soft_light(kind, size), 64, "instances",
                         size < 0.01 ? 3 : 100);
        }
    EXPECT_GT(bits_, 10000000u);
}

TEST_F(SoftExactness, EqualsRaysUnderStretchedCones) {
    for (const glm::dvec2& scale : {glm::dvec2(2, 0.5), {0.3, 1}, {1, 20}})
        for (const double angle_deg : {40.0, 100.0}) {
            Light light = make_soft_light(LightKind::Spot, 0.2);
            light.spot_angle = glm::radians(angle_deg), light.spot_scale = scale;
            expect_exact(random_scene(4, 160, 90), light, 16, "stretched cone", 50);
        }
}

TEST_F(SoftExactness, EqualsRaysForAnyNumberOfSamples) {
    for (const int samples : {2, 3, 16, 63, 65, 200})
        for (const LightKind kind : {LightKind::Point, LightKind::Sun, LightKind::Area})
            expect_exact(make_soup_scene(31, 120, 68), make_soft_light(kind, 0.25), samples, "soup", 30);
    expect_exact(make_soup_scene(32, 64, 36), make_soft_light(LightKind::Sun, 0.25), 1024, "soup");
}

TEST_F(SoftExactness, EqualsRaysOnNeedlesAndFineMeshes) {
    for (unsigned seed = 1; seed <= 3; ++seed)
        for (const LightKind kind : kAllLightKinds)
            expect_exact(make_needle_scene(seed, 120, 68), make_soft_light(kind, 0.1, {0.7, 0.4, 3.5}), 16, "needles",
                         20);
    SceneView ball = place_over_plane("ball", make_rough_ball(2, 1, 0.02f), 200, 112);
    ball.scene->instances.back().world_from_object = placement({0, 0, 1.1});
    for (const LightKind kind : kAllLightKinds) expect_exact(ball, make_soft_light(kind, 0.2), 64, "rough ball");
}

TEST_F(SoftExactness, EqualsRaysAtAnyScaleAndPlaceAndMirrored) {
    for (const double scale : {1e-4, 1.0, 1e5})
        for (const glm::dvec3& place : {glm::dvec3(0), {3e3, -7e3, 2e3}})
            for (const double mirror : {1.0, -1.0}) {
                SceneView view = random_scene(13, 120, 68);
                const glm::dmat4 move = glm::scale(glm::translate(glm::dmat4(1), place * scale), glm::dvec3(scale));
                for (std::size_t i = 1; i < view.scene->instances.size(); ++i) {
                    glm::dmat4& matrix = view.scene->instances[i].world_from_object;
                    matrix = matrix * glm::scale(glm::dmat4(1), glm::dvec3(mirror, 1, 1));
                }
                for (Instance& instance : view.scene->instances)
                    instance.world_from_object = move * instance.world_from_object;
                const auto at = [&](glm::dvec3 p) { return glm::dvec3(move * glm::dvec4(p, 1)); };
                view.camera = make_camera(at({3.6, -3.9, 3.6}), at({0, 0, 0.6}), view.width, view.height);
                view.camera.clip_start *= scale, view.camera.clip_end *= scale;
                for (const LightKind kind : {LightKind::Sun, LightKind::Point, LightKind::Area}) {
                    Light light = make_light(kind, at({2, 1.5, 4}), at({0, 0, 0.3}));
                    light.radius = 0.5 * scale, light.area_size = {1.2 * scale, 0.5 * scale}, light.sun_angle = 0.3;
                    expect_exact(view, light, 16, "scale " + std::to_string(scale));
                }
            }
}

TEST_F(SoftExactness, EqualsRaysWithTheLightAmongTheCasters) {
    for (const glm::dvec3& place : {glm::dvec3(0.1, 0.2, 0.9), {0.4, -0.3, 0.25}, {-0.8, 0.5, 1.4}})
        for (const LightKind kind : {LightKind::Point, LightKind::Spot, LightKind::Area})
            for (const double size : {0.1, 1.0}) {
                Light light = make_light(kind, place, {0.3, 0.3, -2}, 150);
                light.radius = 0.5 * size, light.area_size = {size, size};
                expect_exact(make_soup_scene(9, 120, 68), light, 32, "light inside", 20);
            }
}

struct StrangeLight {
    const char* what;
    LightKind kind;
    double size;
    glm::dvec3 place, target;
    bool is_tie =
        false;  ///< the light lies in a receiver's plane: faces and sight lines along it may be told either way
};

TEST_F(SoftExactness, EqualsRaysUnderStrangeLights) {
    const SceneView scene = random_scene(21, 96, 54);
    const glm::dvec3 eye(scene.camera.world_from_camera[3]);
    const StrangeLight lights[] = {
        {"next to no size", LightKind::Point, 1e-9, {2, 1.5, 4}, {0, 0, 0}},
        {"next to no size", LightKind::Area, 1e-9, {2, 1.5, 4}, {0, 0, 0}},
        {"next to no size", LightKind::Sun, 1e-9, {2, 1.5, 4}, {0, 0, 0}},
        {"larger than the scene", LightKind::Point, 60, {5, 4, 40}, {0, 0, 0}},
        {"larger than the scene", LightKind::Area, 60, {1, 1, 6}, {0, 0, 0}},
        {"half the sky", LightKind::Sun, 1e3, {2, 1.5, 4}, {0, 0, 0}},
        {"around the camera", LightKind::Point, 1.5, eye, {0, 0, 0}},
        {"around the camera", LightKind::Area, 1.5, eye + glm::dvec3(0.01, 0, 0.02), {0, 0, 0}},
        {"around receivers", LightKind::Point, 2.0, {0.3, 0.2, 0.6}, {0, 0, 0}},
        {"around receivers", LightKind::Spot, 2.0, {0.3, 0.2, 0.6}, {0, 0, -3}},
        {"touches the floor", LightKind::Point, 1.0, {1.8, -1.4, 0.5}, {0, 0, 0}},
        {"through the floor", LightKind::Area, 1.5, {1.8, -1.4, 0.1}, {0, 0, 0.1}},
        {"edge-on to the floor", LightKind::Area, 1.5, {3, 0, 1.2}, {0, 0, 1.2}},
        {"in the floor", LightKind::Area, 1.0, {1.8, -1.4, 0}, {1.8, -1.4, 1}, true},
        {"on the floor, downwards", LightKind::Area, 1.0, {1.8, -1.4, 0}, {1.8, -1.4, -1}, true},
    };
    for (const StrangeLight& item : lights) {
        Light light = make_light(item.kind, item.place, item.target, 120);
        light.radius = 0.5 * item.size, light.area_size = glm::dvec2(item.size, 0.7 * item.size);
        light.sun_angle = std::min(item.size, 3.1);
        const SoftComparison found = compare_soft(runner_, scene, light, 32);
        EXPECT_EQ(found.wrong, 0u) << item.what << ", kind " << int(item.kind);
        if (item.is_tie) continue;
        EXPECT_LE(found.ties, 2 + found.bits / 20000) << item.what;
        EXPECT_GT(found.lit + found.penumbra, 200u) << item.what;
        EXPECT_GT(found.dark + found.penumbra, 200u) << item.what;
    }
}

TEST_F(SoftExactness, LinkingLeavesOutCastersAndReceivers) {
    SceneView view = random_scene(6, 160, 90);
    for (std::size_t i = 0; i < view.scene->instances.size(); ++i) {
        view.scene->instances[i].blocker_group = std::uint8_t(i % 3);
        view.scene->instances[i].receiver_group = std::uint8_t(i % 4);
    }
    view.scene->instances[2].flags = kInstanceCamera | kInstanceHoldout;
    view.scene->instances[3].flags = kInstanceShadow;
    for (const LightKind kind : kAllLightKinds) {
        Light light = make_soft_light(kind, 0.3);
        light.blocker_set = ~std::uint64_t{2}, light.receiver_set = ~std::uint64_t{4};
        expect_exact(view, light, 32, "linking");
    }
}

/// Sixteen shifts of the pattern, one for each pixel of 4 x 4: which, the rays must find out.
TEST_F(SoftExactness, RotatedPixelsEachTakeAShiftOfThePattern) {
    constexpr int kShifts = 16;
    for (const auto& [kind, count] :
         {std::pair{LightKind::Sun, 8}, {LightKind::Point, 8}, {LightKind::Area, 8}, {LightKind::Spot, 65}}) {
        SceneView view = count > 8 ? make_soup_scene(41, 48, 28) : make_soup_scene(41, 96, 56);
        const Light light = make_soft_light(kind, 0.5);
        view.scene->lights = {light};
        const TechniqueRun run = runner_.render(
            view, "soft", parameters({{"light_samples", std::int64_t{count}}, {"pattern", std::string("rotated")}}));
        const truth::RayOracle oracle(view.scene);
        const std::vector<PatternShift> shifts = find_pattern_shifts(LightPattern::Spiral, count, kShifts);
        std::array<std::array<int, kShifts>, 16> wrong{};
        for (int shift = 0; shift < kShifts; ++shift) {
            const auto samples = sample_light_shape(light, count, LightPattern::Spiral, shifts[std::size_t(shift)]);
            const truth::SampleShadows shadows(oracle, *run.frame, light, samples);
            for (std::size_t pixel = 0; pixel < run.frame->pixel_count(); ++pixel) {
                const std::size_t x = pixel % std::size_t(run.frame->width), y = pixel / std::size_t(run.frame->width);
                const truth::LitPart part = shadows.find_lit_part(pixel);
                const double value = double(run.visibility()[pixel]);
                wrong[4 * (y % 4) + x % 4][std::size_t(shift)] +=
                    value < part.least - kSoftRounding || value > part.most + kSoftRounding;
            }
        }
        std::array<int, kShifts> taken{};
        for (const auto& of_place : wrong) {
            const auto found = std::find(of_place.begin(), of_place.end(), 0);
            ASSERT_NE(found, of_place.end()) << "no shift fits; kind " << int(kind);
            ++taken[std::size_t(found - of_place.begin())];
            EXPECT_EQ(std::count(of_place.begin(), of_place.end(), 0), 1) << "the light is too small to tell";
        }
        EXPECT_EQ(std::count(taken.begin(), taken.end(), 1), kShifts) << "some shift is taken twice";
    }
}

TEST_F(SoftExactness, OneSampleIsTheHardLayerToTheBit) {
    for (const LightKind kind : kAllLightKinds)
        for (SceneView view : {random_scene(7, 240, 135), make_soup_scene(7, 240, 135), tower_scene(240, 135)}) {
            view.scene->lights = {make_soft_light(kind, 0.3)};
            const auto hard = render(view, "exact", {});
            EXPECT_EQ(render(view, "soft", parameters({{"light_samples", std::int64_t{1}}})), hard);
            Light& light = view.scene->lights[0];
            light.radius = light.sun_angle = 0, light.area_size = glm::dvec2(0);
            EXPECT_EQ(render(view, "soft", {}), hard) << "a light without size";
        }
}

TEST_F(SoftExactness, ManySamplesAreTheMeanOfHardLayers) {
    std::vector<Light> lights;
    for (const LightKind kind : kAllLightKinds) lights.push_back(make_soft_light(kind, 0.2));
    for (const bool is_round : {true, false}) {
        lights.push_back(make_soft_light(LightKind::Area, 0.2));
        lights.back().area_round = is_round, lights.back().area_size.y = lights.back().area_size.x;
        lights.push_back(lights.back());
        lights.back().area_size.y *= 0.25;
    }
    for (const Light& light : lights)
        for (SceneView view : {random_scene(8, 160, 90), make_soup_scene(8, 120, 68), tower_scene(80, 45),
                               make_needle_scene(8, 80, 45), box_scene(80, 45)}) {
            view.scene->lights = {light};
            const auto soft = render(view, "soft", parameters({{"light_samples", std::int64_t{32}}}));
            const auto mean = render(
                view, "multi", parameters({{"positions", std::int64_t{32}}, {"technique", std::string("exact")}}));
            double largest = 0;
            for (std::size_t pixel = 0; pixel < soft.size(); ++pixel)
                largest = std::max(largest, std::abs(double(soft[pixel]) - double(mean[pixel])));
            EXPECT_LT(largest, kSoftRounding) << int(light.kind) << ", round " << light.area_round;
        }
}

}  // namespace
}  // namespace shadow_layers::testing
