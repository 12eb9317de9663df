// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Sub-pixel shadow maps: sample by sample against rays on the same places, where the receivers are flat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/ray_comparison.h"
#include "support/soup_scene.h"
#include "techniques/fsasm/sample_mask.h"
#include "truth/border_error.h"
#include "truth/pixel_samples.h"
#include "truth/plane_shadow.h"

namespace shadow_layers::testing {
namespace {

/// Only the first instance is seen, a flat receiver. The others are lifted: where a caster dips into the receiver no
/// silhouette marks the border, and dips smaller than a pixel are overlooked. The receiver is of two triangles: rays
/// from beyond a triangle's neighbours meet flat ones by rounding.
SceneView hide_casters(SceneView view, double lift = 1.2) {
    view.scene->meshes[0] = to_mesh("plane", make_plane(14));
    for (std::size_t i = 1; i < view.scene->instances.size(); ++i) {
        view.scene->instances[i].flags = kInstanceShadow;
        view.scene->instances[i].world_from_object[3].z += lift;
    }
    return view;
}

std::vector<glm::dvec2> list_offsets(const SamplePlaces& places) {
    std::vector<glm::dvec2> offsets;
    for (std::size_t i = 0; i < std::size_t(places.count); ++i)
        offsets.push_back({double(places.x[i]), double(places.y[i])});
    return offsets;
}

class FSASM : public ::testing::Test {
protected:
    /// Rays at the technique's own sample places on each pixel's facet.
    std::vector<float> compute_facet_truth(const SceneView& view, const TechniqueRun& run, SamplePlacement placement,
                                           int samples) {
        const truth::RayOracle oracle(view.scene);
        const Frame& frame = *run.frame;
        const truth::PixelSamples rays(oracle, frame, view.scene->lights[0], run.positions.at(0));
        const auto offsets = list_offsets(make_sample_places(placement, samples));
        std::vector<float> truth(frame.pixel_count());
        runner_.engine().threads().parallel_for(truth.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t pixel = begin; pixel < end; ++pixel) {
                const auto lit = rays.find_visibility(pixel, offsets, truth::SampleReceiver::CentreFacet);
                truth[pixel] = float(std::count(lit.begin(), lit.end(), 1)) / float(samples);
            }
        });
        return truth;
    }

    /// Pixels whose number of lit samples differs from that of the rays; `borders_` counts pixels partly lit. Pixels at
    /// the receivers' rim are left out: their facets reach past what the light's views hold.
    int count_different(SceneView view, const Light& light, int samples, const char* pattern = "lattice",
                        std::int64_t map_size = 256) {
        view.scene->lights = {light};
        ParameterValues values = parameters({{"validity", std::string("off")}});
        values.set("samples", std::to_string(samples));
        values.set("pattern", std::string(pattern));
        values.set("map_size", map_size);
        const TechniqueRun run = runner_.render(view, "fsasm", values);
        counters_ = run.stats.counters;
        const auto placement = std::string(pattern) == "grid" ? SamplePlacement::Grid : SamplePlacement::Lattice;
        const std::vector<float> truth = compute_facet_truth(view, run, placement, samples);
        int different = 0;
        borders_ = 0;
        for (int y = 1; y + 1 < run.frame->height; ++y)  // without the overscan
            for (int x = 1; x + 1 < run.frame->width; ++x) {
                const std::size_t width = std::size_t(run.frame->width),
                                  pixel = std::size_t(y) * width + std::size_t(x);
                const auto& covered = run.frame->coverage;
                if (!covered[pixel - 1] || !covered[pixel + 1] || !covered[pixel - width] || !covered[pixel + width])
                    continue;
                different += run.visibility()[pixel] != truth[pixel];
                borders_ += truth[pixel] > 0 && truth[pixel] < 1;
            }
        return different;
    }

    TechniqueRunner runner_;
    std::map<std::string, std::int64_t> counters_;
    int borders_ = 0;
};

TEST_F(FSASM, SamplesEqualRaysOnAFlatReceiver) {
    for (const LightKind kind : kAllLightKinds)
        for (const int samples : {8, 32, 64, 128}) {
            EXPECT_EQ(count_different(hide_casters(random_scene(31, 200, 112)),
                                      make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80), samples),
                      0)
                << int(kind) << ", " << samples;
            EXPECT_GT(borders_, 300);
        }
}

TEST_F(FSASM, SamplesEqualRaysInAGrid) {
    const Light light = make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0.5}, 80);
    EXPECT_EQ(count_different(hide_casters(random_scene(32, 200, 112)), light, 32, "grid"), 0);
    EXPECT_EQ(count_different(hide_casters(tower_scene(200, 112)), light, 128, "grid"), 0);
}

TEST_F(FSASM, SamplesEqualRaysUnderSoups) {
    for (unsigned seed = 1; seed <= 6; ++seed)
        EXPECT_EQ(count_different(hide_casters(make_soup_scene(seed)),
                                  make_light(kAllLightKinds[seed % 4], {1.5, 1.0, 5.0}, {0, 0, 0.5}, 90), 32),
                  0)
            << "seed " << seed;
}

TEST_F(FSASM, SamplesEqualRaysWithTheLightAmongTheCasters) {
    for (const glm::dvec3& place : {glm::dvec3(0.1, 0.2, 0.9), {0.4, -0.3, 0.25}, {-0.8, 0.5, 1.4}})
        for (const LightKind kind : {LightKind::Point, LightKind::Spot})
            EXPECT_EQ(
                count_different(hide_casters(make_soup_scene(9)), make_light(kind, place, {0.3, 0.3, -2}, 150), 32), 0);
}

// What the paper's samples are for: the part of the pixel that is lit, against its exact area.
TEST_F(FSASM, BorderPixelsAreAsLitAsTheirArea) {
    for (const auto& [samples, bound] : {std::pair{"32", 1.0 / 48}, {"128", 1.0 / 96}})
        for (const char* pattern : {"lattice", "grid"})
            for (const LightKind kind : kAllLightKinds) {
                SceneView view = hide_casters(random_scene(35, 320, 180));
                view.scene->lights = {make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80)};
                const TechniqueRun run = runner_.render(
                    view, "fsasm", parameters({{"samples", std::string(samples)}, {"pattern", std::string(pattern)}}));
                const truth::RayOracle oracle(view.scene);
                const truth::TriangleTree tree(oracle, *view.scene);
                const truth::PlaneShadows areas(oracle, tree, *run.frame, view.scene->lights[0], run.positions.at(0));
                truth::BorderError error;
                for (std::size_t pixel = 0; pixel < run.visibility().size(); ++pixel)
                    if (const auto lit = areas.find_lit_part(pixel)) error.add(run.visibility()[pixel], *lit);
                EXPECT_GT(error.pixels(), 700u);
                EXPECT_LT(error.compute_mean(), bound) << samples << " " << pattern << " " << int(kind);
                RecordProperty("border_mae", std::to_string(error.compute_mean()));
            }
}

// Their borders on the receiver are found by the pixels' centres, but for dips smaller than a pixel.
TEST_F(FSASM, CastersThatDipIntoTheReceiverLackFewSamples) {
    for (const LightKind kind : kAllLightKinds) {
        const Light light = make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80);
        EXPECT_LE(count_different(hide_casters(random_scene(31, 200, 112), 0), light, 64), 4) << int(kind);
        EXPECT_GT(borders_, 300);
    }
}

// What the camera does not see hides nothing of the receiver, though it comes near it.
TEST_F(FSASM, CastersThatAreNotSeenTakeNoSamples) {
    SceneView view = hide_casters(random_scene(31, 200, 112), 0);
    view.scene->lights = {make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0.5}, 80)};
    const auto count_lost = [&](const char* validity) {
        const TechniqueRun run = runner_.render(view, "fsasm", parameters({{"validity", std::string(validity)}}));
        EXPECT_GT(run.stats.counters.at("contacts"), 100) << validity;
        return 32 * run.stats.counters.at("silhouette_pixels") - run.stats.counters.at("valid_samples");
    };
    for (const char* validity : {"seen", "line"}) EXPECT_EQ(count_lost(validity), 0) << validity;
    for (Instance& instance : view.scene->instances) instance.flags |= kInstanceCamera;
    for (const char* validity : {"seen", "line"}) EXPECT_GT(count_lost(validity), 50) << validity;
}

// The rim of the cone cuts pixels, too.
TEST_F(FSASM, SamplesEqualRaysAtTheRimOfACone) {
    EXPECT_EQ(count_different(hide_casters(tower_scene(200, 112)),
                              make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0.5}, 25), 32),
              0);
    EXPECT_GT(borders_, 100);
}

// Many flat triangles in one plane: what lies beyond a neighbour is flat, too, as far as float corners can be.
TEST_F(FSASM, AFineFlatReceiverDoesNotShadowItself) {
    for (const double turn : {0.0, 27.0}) {
        SceneView view;
        view.width = 160, view.height = 90;
        view.place(view.add("floor", make_plane(6, 150)), placement({0.1, 0.2, 0.03}, turn, {0.3, 0.1, 1}));
        view.place(view.add("box", make_box({1, 0.8f, 1.2f})), placement({0.1, -0.05, 1.1}, 27), kInstanceShadow);
        view.camera = make_camera({1.2, -2.1, 2.4}, {0.3, 0.3, 0.0}, view.width, view.height);
        for (const LightKind kind : kAllLightKinds) {
            const auto values = parameters({{"validity", std::string("off")}, {"map_size", std::int64_t(256)}});
            view.scene->lights = {make_light(kind, {2, 1.5, 4}, {0, 0, 0.3}, 90)};
            const auto fine = runner_.render(view, "fsasm", values).visibility();
            SceneView coarse = view;
            coarse.scene = std::make_shared<Scene>(*view.scene);
            coarse.scene->meshes[0] = to_mesh("floor", make_plane(6));
            const auto plain = runner_.render(coarse, "fsasm", values).visibility();
            int different = 0;
            for (std::size_t pixel = 0; pixel < fine.size(); ++pixel)
                different += std::abs(fine[pixel] - plain[pixel]) > 1.5f / 32;
            EXPECT_EQ(different, 0) << int(kind);
        }
    }
}

TEST_F(FSASM, DoesNotDependOnTheMapSize) {
    for (const std::int64_t size : {1, 7, 64, 333, 2048})
        for (const LightKind kind : {LightKind::Spot, LightKind::Point})
            EXPECT_EQ(count_different(hide_casters(random_scene(33, 112, 63, 6)),
                                      make_light(kind, {2, 1.5, 4}, {0, 0, 0}), 32, "lattice", size),
                      0)
                << size;
}

TEST_F(FSASM, EqualsRaysAtAnyScaleAndPlace) {
    for (const double scale : {1e-4, 1.0, 1e5})
        for (const glm::dvec3& place : {glm::dvec3(0), {3e5, -7e5, 2e5}}) {
            SceneView view = hide_casters(random_scene(34, 160, 90));
            const glm::dmat4 move = glm::scale(glm::translate(glm::dmat4(1), place * scale), glm::dvec3(scale));
            for (Instance& instance : view.scene->instances)
                instance.world_from_object = move * instance.world_from_object;
            const auto at = [&](glm::dvec3 p) { return glm::dvec3(move * glm::dvec4(p, 1)); };
            view.camera = make_camera(at({3.6, -3.9, 3.6}), at({0, 0, 0.6}), view.width, view.height);
            view.camera.clip_start *= scale, view.camera.clip_end *= scale;
            for (const LightKind kind : {LightKind::Spot, LightKind::Sun})
                EXPECT_EQ(count_different(view, make_light(kind, at({2, 1.5, 4}), at({0, 0, 0}), 80), 32), 0) << scale;
        }
}

// Without the mask the part of a facet that reaches under the wall is in the wall's shadow.
TEST_F(FSASM, ValidityDropsWhatLiesBehindAWall) {
    SceneView view;
    view.width = 160, view.height = 90;
    view.place(view.add("floor", make_plane(6)), glm::dmat4(1));
    view.place(view.add("wall", make_box({4, 0.5f, 1})), placement({0, 1, 0.5}, 0));
    view.place(view.add("post", make_box({0.1f, 0.1f, 2})), placement({0.3, -0.5, 1.5}, 10), kInstanceShadow);
    view.camera = make_camera({0.4, -4, 1.6}, {0, 0.5, 0.3}, view.width, view.height);
    view.scene->lights = {make_light(LightKind::Sun, {1.2, -3, 4}, {0, 0, 0})};
    const auto count_darkened = [&](const char* validity) {
        const TechniqueRun run = runner_.render(view, "fsasm", parameters({{"validity", std::string(validity)}}));
        const RayComparison rays = compare_with_rays(runner_, view, view.scene->lights[0], "exact");
        int darkened = 0;
        for (int y = 1; y < view.height - 1; ++y)
            for (int x = 1; x < view.width - 1; ++x) {
                bool lit = true;  // all around, so that the pixel is far from any true border
                for (int j = -1; j <= 1; ++j)
                    for (int i = -1; i <= 1; ++i)
                        lit = lit && rays.truth[std::size_t((y + j) * view.width + x + i)] == 1;
                darkened += lit && run.visibility()[std::size_t((y + 1) * run.frame->width + x + 1)] < 1;
            }
        return darkened;
    };
    const int all = count_darkened("off");
    EXPECT_GT(all, 10);
    EXPECT_LT(count_darkened("line"), all / 10);
    EXPECT_EQ(count_darkened("seen"), 0);
}

TEST_F(FSASM, TheTableIsNearToWhatIsComputed) {
    SceneView view = hide_casters(tower_scene(320, 180));
    view.scene->lights = {make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0.5}, 80)};
    const auto computed = runner_.render(view, "fsasm").visibility();
    const auto looked_up = runner_.render(view, "fsasm", parameters({{"masks", std::string("table")}})).visibility();
    double sum = 0;
    int borders = 0;
    for (std::size_t pixel = 0; pixel < computed.size(); ++pixel) {
        if (computed[pixel] == 0 || computed[pixel] == 1) continue;
        ++borders;
        sum += std::abs(double(computed[pixel]) - double(looked_up[pixel]));
    }
    EXPECT_GT(borders, 500);
    EXPECT_GT(sum, 0);
    EXPECT_LT(sum / borders, 0.01);
}

TEST_F(FSASM, CountsWhatTheTableOfThePaperCounts) {
    count_different(hide_casters(tower_scene(200, 112)), make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0.5}, 80), 32);
    for (const char* name : {"silhouette_texels", "silhouette_pixels", "visibility_evaluations", "pixel_texel_pairs",
                             "triangle_texel_pairs", "valid_samples"})
        EXPECT_GT(counters_[name], 0) << name;
    EXPECT_GE(counters_["silhouette_pixels"], borders_);
    EXPECT_GE(counters_["pixel_texel_pairs"], counters_["silhouette_pixels"]);
    EXPECT_LE(counters_["valid_samples"], 32 * counters_["silhouette_pixels"]);
}

}  // namespace
}  // namespace shadow_layers::testing
