// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Alias-free shadow maps against rays: no pixel may differ, whatever the scene, the light and the map's size.
#include "techniques/afsm/afsm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "support/ray_comparison.h"
#include "support/soup_scene.h"
#include "truth/border_error.h"
#include "truth/pixel_means.h"
#include "truth/pixel_samples.h"
#include "truth/plane_shadow.h"

namespace shadow_layers::testing {
namespace {

class AFSM : public ::testing::Test {
protected:
    /// Pixels that differ from the rays; of those that the casters decide so many must be lit, and so many not.
    int count_different(SceneView view, const Light& light, std::int64_t map_size, int least = 200) {
        const RayComparison found =
            compare_with_rays(runner_, std::move(view), light, "afsm", parameters({{"map_size", map_size}}));
        counters_ = found.run.stats.counters;
        EXPECT_GE(found.lit, least);
        EXPECT_GE(found.shadowed, least);
        return found.different;
    }
    TechniqueRunner runner_;
    std::map<std::string, std::int64_t> counters_;
};

TEST_F(AFSM, EqualsRaysOnSoups) {
    for (unsigned seed = 1; seed <= 8; ++seed)
        EXPECT_EQ(count_different(make_soup_scene(seed),
                                  make_light(kAllLightKinds[seed % 4], {1.5, 1.0, 5.0}, {0, 0, 0.5}, 90), 256),
                  0)
            << "seed " << seed;
}

TEST_F(AFSM, EqualsRaysOnClosedMeshes) {
    for (const LightKind kind : kAllLightKinds) {
        EXPECT_EQ(count_different(random_scene(21, 400, 225), make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80), 512), 0);
        EXPECT_EQ(count_different(tower_scene(400, 225), make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80), 512), 0);
    }
}

TEST_F(AFSM, EqualsRaysWithTheLightAmongTheCasters) {
    for (const glm::dvec3& place : {glm::dvec3(0.1, 0.2, 0.9), {0.4, -0.3, 0.25}, {-0.8, 0.5, 1.4}})
        for (const LightKind kind : {LightKind::Point, LightKind::Spot})
            EXPECT_EQ(count_different(make_soup_scene(9), make_light(kind, place, {0.3, 0.3, -2}, 150), 256, 0), 0);
}

TEST_F(AFSM, DoesNotDependOnTheMapSize) {
    for (const std::int64_t size : {1, 7, 64, 333, 2048})
        for (const LightKind kind : {LightKind::Spot, LightKind::Point})
            EXPECT_EQ(count_different(random_scene(22, 112, 63, 6), make_light(kind, {2, 1.5, 4}, {0, 0, 0}), size, 60),
                      0)
                << size;
}

TEST_F(AFSM, EqualsRaysAtAnyScaleAndPlace) {
    for (const double scale : {1e-4, 1.0, 1e5})
        for (const glm::dvec3& place : {glm::dvec3(0), {3e5, -7e5, 2e5}}) {
            SceneView view = random_scene(23, 240, 135);
            const glm::dmat4 move = glm::scale(glm::translate(glm::dmat4(1), place * scale), glm::dvec3(scale));
            for (Instance& instance : view.scene->instances)
                instance.world_from_object = move * instance.world_from_object;
            const auto at = [&](glm::dvec3 p) { return glm::dvec3(move * glm::dvec4(p, 1)); };
            view.camera = make_camera(at({3.6, -3.9, 3.6}), at({0, 0, 0.6}), view.width, view.height);
            view.camera.clip_start *= scale, view.camera.clip_end *= scale;
            for (const LightKind kind : {LightKind::Spot, LightKind::Sun})
                EXPECT_EQ(count_different(view, make_light(kind, at({2, 1.5, 4}), at({0, 0, 0}), 80), 512), 0) << scale;
        }
}

TEST_F(AFSM, EqualsRaysFromAFarNarrowSpot) {
    const Light light = make_light(LightKind::Spot, {4e4, 3e4, 8e4}, {0, 0, 0.5}, 0.004);
    EXPECT_EQ(count_different(random_scene(24, 240, 135), light, 512), 0);
}

TEST_F(AFSM, EqualsRaysOnModels) {
    int tried = 0;
    for (const char* name : {"scorpion", "teapot"}) {
        const auto model = load_obj(std::string(SHADOW_LAYERS_SHADER_DIR) + "/../../shared/models/" + name + ".obj");
        if (!model) continue;
        ++tried;
        for (const LightKind kind : kAllLightKinds)
            EXPECT_EQ(
                count_different(model_scene(*model, 480, 270), make_light(kind, {2, 1.5, 4}, {0, 0, 0.3}, 70), 1024), 0)
                << name;
    }
    if (tried == 0) GTEST_SKIP() << "no ../shared/models";
}

// Receivers on the copies of a plane are open against every copy: more pairs than the buffer holds.
TEST_F(AFSM, LosesNoOpenPairs) {
    SceneView view;
    view.width = 64, view.height = 36;
    const auto plane = view.add("plane", make_plane(12));
    for (int copy = 0; copy < 6; ++copy) view.place(plane);
    view.place(view.add("box", make_box({1, 0.8f, 1.2f})), placement({0.1, -0.05, 1.1}, 27));
    view.camera = make_camera({3.2, -4.1, 3.4}, {0.3, 0.3, 0.3}, view.width, view.height);
    for (const LightKind kind : kAllLightKinds) {
        EXPECT_EQ(count_different(view, make_light(kind, {2, 1.5, 4}, {0, 0, 0.3}, 90), 64, 100), 0);
        EXPECT_GT(counters_.at("redraws"), 0);
        EXPECT_GT(counters_.at("open_pairs"), counters_.at("receivers"));
    }
}

TEST_F(AFSM, SettlesFewPairsInDouble) {
    SceneView view = random_scene(25, 640, 360);
    view.scene->lights = {make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0})};
    const auto counters = runner_.render(view, "afsm").stats.counters;
    EXPECT_GT(counters.at("list_tests"), 10000);
    EXPECT_LT(counters.at("open_pairs"), counters.at("receivers") / 50);
    EXPECT_EQ(counters.at("redraws"), 0);
}

/// The mean of the rays' answers at the technique's places in the pixel.
std::vector<float> compute_mean_truth(TechniqueRunner& runner, const SceneView& view, const TechniqueRun& run,
                                      int samples) {
    FrameMaker maker(runner.engine(), std::make_shared<FramePool>(),
                     {view.scene, view.camera, view.width, view.height, {0, 0, view.width, view.height}, 0});
    maker.make(glm::dvec2(0.0));
    const truth::RayOracle oracle(view.scene);
    std::vector<int> lit(run.visibility().size());
    for (int k = 0; k < samples; ++k) {
        const auto frame = maker.make(get_afsm_offset(k, samples));
        const auto truth = oracle.compute_visibility(*frame, view.scene->lights[0], run.positions.at(0));
        for (std::size_t pixel = 0; pixel < lit.size(); ++pixel) lit[pixel] += truth[pixel] > 0.5f;
    }
    std::vector<float> mean;
    for (const int count : lit) mean.push_back(float(count) / float(samples));
    return mean;
}

TEST_F(AFSM, SamplesAverageExactAnswers) {
    for (const LightKind kind : kAllLightKinds) {
        SceneView view = random_scene(26, 120, 68);
        view.scene->lights = {make_light(kind, {2, 1.5, 4}, {0, 0, 0.3}, 70)};
        const TechniqueRun run =
            runner_.render(view, "afsm", parameters({{"samples", std::int64_t(5)}, {"map_size", std::int64_t(128)}}));
        EXPECT_EQ(run.visibility(), compute_mean_truth(runner_, view, run, 5));
    }
}

/// What the layer of so many samples is held against.
struct PixelComparison {
    truth::BorderError border;
    double bias = 0;            ///< mean of the layer less the truth, over the pixels turned to the light
    int planes = 0, mixed = 0;  ///< pixels that see one plane alone; those of them that are neither lit nor dark
    int different = 0;          ///< of these, where the layer is not the mean of the places' own exact answers
};

PixelComparison compare_with_squares(TechniqueRunner& runner, const SceneView& view, int samples) {
    const TechniqueRun run = runner.render(view, "afsm", parameters({{"samples", std::int64_t(samples)}}));
    const Light& light = view.scene->lights[0];
    const LightSample& position = run.positions.at(0);
    const truth::RayOracle oracle(view.scene);
    const truth::TriangleTree tree(oracle, *view.scene);
    const Frame& frame = *run.frame;
    const auto means =
        truth::compute_pixel_means(oracle, tree, frame, light, position, runner.engine().threads(), [] {});
    const truth::PlaneShadows planes(oracle, tree, frame, light, position);
    const truth::PixelSamples places(oracle, frame, light, position);
    std::vector<glm::dvec2> offsets;
    for (int k = 0; k < samples; ++k) offsets.push_back(get_afsm_offset(k, samples));
    const FacingRule facing(frame, light, position);
    PixelComparison result;
    int counted = 0;
    for (std::size_t pixel = 0; pixel < means.size(); ++pixel) {
        if (facing.classify(pixel) != Facing::Undecided) continue;
        const float layer = run.visibility()[pixel];
        result.border.add(double(layer), double(means[pixel]));
        result.bias += double(layer) - double(means[pixel]);
        ++counted;
        if (!planes.sees_plane_alone(pixel)) continue;
        const auto lit = places.find_visibility(pixel, offsets, truth::SampleReceiver::OwnRay);
        result.different += layer != float(std::accumulate(lit.begin(), lit.end(), 0)) / float(samples);
        result.mixed += layer > 0 && layer < 1;
        ++result.planes;
    }
    result.bias /= std::max(counted, 1);
    return result;
}

// Against areas, not against its own places: more of them come nearer. Each place by itself is exact.
TEST_F(AFSM, SamplesApproachThePixelsSquare) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot}) {
        SceneView view = random_scene(27, 160, 90);
        view.scene->lights = {make_light(kind, {2, 1.5, 4}, {0, 0, 0.3}, 70)};
        double last = 1;
        for (const int samples : {4, 16, 64}) {
            const PixelComparison found = compare_with_squares(runner_, view, samples);
            EXPECT_EQ(found.different, 0);
            EXPECT_GT(found.planes, 4000);
            EXPECT_GT(found.mixed, 100);
            EXPECT_GT(found.border.pixels(), 300u);
            EXPECT_LT(std::abs(found.bias), 0.002);
            const double error = found.border.compute_mean();
            EXPECT_LT(error, 0.5 * last) << samples;
            last = error;
        }
        EXPECT_LT(last, 0.02);
    }
}

// A post that only some of the moved frames see, and whose receivers lie outside what the pixels' centres see.
TEST_F(AFSM, SamplesCoverWhatOnlyMovedFramesSee) {
    SceneView view;
    view.width = 9, view.height = 9;
    view.place(view.add("post", make_box({0.02f, 4, 0.02f})), placement({0.051, 0, 0}, 3, {0, 0, 1}));
    view.place(view.add("shade", make_plane(0.6f)), placement({0.6, 0.3, 0.5}, 0), kInstanceShadow);
    view.camera = make_camera({0, 0, 3}, {0, 0, 0}, view.width, view.height, 20);
    view.scene->lights = {make_light(LightKind::Spot, {1.2, 0.5, 1}, {0, 0, 0}, 120)};
    const TechniqueRun run = runner_.render(view, "afsm", parameters({{"samples", std::int64_t(16)}}));
    const auto truth = compute_mean_truth(runner_, view, run, 16);
    EXPECT_EQ(run.visibility(), truth);
    EXPECT_LT(*std::min_element(truth.begin(), truth.end()), 1.0f);
}

}  // namespace
}  // namespace shadow_layers::testing
