// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Embree's own shadows, which benchmarks time, against the rays in double: they must be shadows of the same scene.
#include "truth/shadow_rays.h"

#include <gtest/gtest.h>

#include "lights/facing.h"
#include "lights/light_shape.h"
#include "support/ray_oracle.h"
#include "support/technique_scenes.h"

namespace shadow_layers::testing {
namespace {

/// What a render with auxiliary pictures gives.
FrameResult to_result(const Frame& frame) {
    FrameResult result;
    result.camera_position = frame.origin_ws;
    result.coverage = {frame.width, frame.height, 1, {}};
    Image &position = result.aux["position"], &normal = result.aux["normal"];
    for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
        result.coverage.data.push_back(frame.coverage[pixel]);
        for (int k = 0; k < 3; ++k) {
            position.data.push_back(frame.positions_rel[pixel][k]);
            normal.data.push_back(frame.normals[pixel][k]);
        }
        const bool is_empty = frame.ids[pixel].instance == kNoId;
        result.ids.data.push_back(is_empty ? -1 : std::int64_t(frame.ids[pixel].instance));
        result.ids.data.push_back(is_empty ? -1 : std::int64_t(frame.ids[pixel].triangle));
    }
    return result;
}

TEST(ShadowRays, AreTheShadowsOfTheScene) {
    SceneView view = random_scene(5, 200, 120);
    view.scene->instances[1].blocker_group = 3;
    Light sun = make_light(LightKind::Sun, {2, 1.5, 4}, {0, 0, 0}), spot = make_light(LightKind::Spot, {2, 1, 4}, {});
    spot.blocker_set = ~(std::uint64_t{1} << 3);
    view.scene->lights = {sun, spot};
    const RayOracle oracle(view.scene);
    const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
    RenderRequest request;
    request.scene = view.scene;
    request.jobs = {{0, "sm", {}}, {1, "sm", {}}, {1, "edsm", {}}};
    truth::ShadowRays rays(2);
    for (const truth::ShadowRayMode& mode : truth::get_shadow_ray_modes()) {
        const truth::ShadowRayTimes times = rays.measure(request, to_result(frame), mode);
        ASSERT_EQ(times.lit.size(), 2u) << "each light once";
        std::size_t facing = 0;
        for (std::size_t k = 0; k < 2; ++k) {
            const Light& light = view.scene->lights[k];
            const LightSample position = sample_light_shape(light, 1).front();
            const auto truth = oracle.compute_visibility(frame, light, position);
            const FacingRule rule(frame, light, position);
            std::size_t different = 0, shadowed = 0;
            for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
                shadowed += truth[pixel] < 0.5f;
                if (rule.classify(pixel) != Facing::Undecided) continue;
                ++facing;
                different += (truth[pixel] > 0.5f) != (times.lit[k][pixel] != 0);
            }
            EXPECT_LE(different, truth.size() / 500) << mode.name;
            EXPECT_GT(shadowed, truth.size() / 50) << mode.name;
        }
        EXPECT_EQ(times.receivers, facing) << mode.name;
        EXPECT_EQ(times.rays, facing) << mode.name;
        EXPECT_LE(times.disagreements, facing / 1000) << mode.name;
        EXPECT_GT(times.build_ms, 0);
        EXPECT_GT(times.packets_ms, 0);
        EXPECT_GT(times.stream_ms, 0);
    }
}

TEST(ShadowRays, WithoutMeshesThereIsNothingToShade) {
    RenderRequest request;
    auto scene = std::make_shared<Scene>();
    scene->lights = {make_light(LightKind::Sun, {0, 0, 4}, {0, 0, 0})};
    request.scene = scene;
    request.jobs = {{0, "sm", {}}};
    Frame frame;
    frame.width = 2, frame.height = 1;
    frame.scene = scene;
    frame.positions_rel.resize(2), frame.normals.resize(2), frame.ids.resize(2), frame.coverage.resize(2);
    truth::ShadowRays rays(1);
    for (const truth::ShadowRayMode& mode : truth::get_shadow_ray_modes()) {
        const truth::ShadowRayTimes times = rays.measure(request, to_result(frame), mode);
        EXPECT_EQ(times.receivers, 0u);
        EXPECT_EQ(times.lit.at(0), (std::vector<std::uint16_t>{0, 0}));
    }
}

TEST(ShadowRays, WithoutCastersAllIsLit) {
    SceneView view = box_scene(40, 30);
    for (Instance& instance : view.scene->instances) instance.flags = kInstanceCamera;
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 4}, {0, 0, 0})};
    RenderRequest request;
    request.scene = view.scene;
    request.jobs = {{0, "sm", {}}};
    const Frame frame = RayOracle(view.scene).make_frame(view.camera, view.width, view.height);
    truth::ShadowRays rays(1);
    for (const truth::ShadowRayMode& mode : truth::get_shadow_ray_modes()) {
        const auto lit = rays.measure(request, to_result(frame), mode).lit.at(0);
        const FacingRule rule(frame, view.scene->lights[0], sample_light_shape(view.scene->lights[0], 1).front());
        for (std::size_t pixel = 0; pixel < lit.size(); ++pixel)
            EXPECT_EQ(lit[pixel] != 0, rule.classify(pixel) == Facing::Undecided);
    }
}

// As many rays as the jobs' techniques take samples, to the same places.
TEST(ShadowRays, GoToTheSamplesOfTheLight) {
    SceneView view = random_scene(5, 96, 54);
    view.scene->lights = {make_light(LightKind::Area, {2, 1.5, 4}, {0, 0, 0})};
    view.scene->lights[0].area_size = {2, 1};
    const RayOracle oracle(view.scene);
    const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
    ParameterValues sixteen;
    sixteen.set("positions", std::int64_t{16});
    RenderRequest request;
    request.scene = view.scene;
    request.jobs = {{0, "multi", sixteen}, {0, "multi", sixteen}};
    truth::ShadowRays rays(2);
    const auto times = rays.measure(request, to_result(frame), truth::get_shadow_ray_modes()[0]);
    ASSERT_EQ(times.lit.size(), 1u) << "jobs with the same samples are one";
    const Light& light = view.scene->lights[0];
    std::vector<int> expected(frame.pixel_count());
    std::size_t facing = 0, different = 0, penumbra = 0;
    for (const LightSample& sample : sample_light_shape(light, 16, LightPattern::Spiral)) {
        const auto truth = oracle.compute_visibility(frame, light, sample);
        const FacingRule rule(frame, light, sample);
        for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
            if (rule.classify(pixel) != Facing::Undecided) continue;
            ++facing;
            expected[pixel] += truth[pixel] > 0.5f;
        }
    }
    for (std::size_t pixel = 0; pixel < expected.size(); ++pixel) {
        different += std::size_t(std::abs(expected[pixel] - int(times.lit[0][pixel])));
        penumbra += expected[pixel] > 0 && expected[pixel] < 16;
    }
    EXPECT_EQ(times.rays, facing);
    EXPECT_LE(different, facing / 500);
    EXPECT_GT(penumbra, 100u);
}

}  // namespace
}  // namespace shadow_layers::testing
