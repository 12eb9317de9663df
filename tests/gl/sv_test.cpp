// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow volumes against rays and against `exact`. All is decided in double by signs; only pixels whose ray or whose
// way to the light passes an edge within double rounding, or whose id float drew beyond its triangle, may differ.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/ray_comparison.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

/// Open, not manifold, not oriented: triangles of all sizes, slivers among them, three and more at an edge, some twice.
MeshData make_tangle(unsigned seed, int count, float size) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto point = [&](float scale) { return glm::vec3(unit(random), unit(random), unit(random)) * scale; };
    MeshData soup;
    for (int k = 0; k < count; ++k) {
        const auto first = std::uint32_t(soup.positions.size());
        const glm::vec3 middle = point(1.5f) + glm::vec3(0, 0, 1.6f), along = point(size);
        soup.positions.insert(
            soup.positions.end(),
            {middle, middle + along, middle + (k % 3 == 0 ? along * 0.5f + point(size * 1e-3f) : point(size))});
        soup.triangles.push_back({first, first + 1, first + 2});
        if (k > 0) soup.triangles.push_back({first, first + 1, first - 1});
        if (k > 1) soup.triangles.push_back({first, first + 1, first - 4});
        if (k % 8 == 0) soup.triangles.push_back({first + 1, first, first + 2});
    }
    return soup;
}

SceneView tangle_scene(unsigned seed, int count = 120) {
    return place_over_plane("tangle", make_tangle(seed, count, 0.8f));
}

class ShadowVolumesTest : public ::testing::Test {
protected:
    /// 20 in a million pixels or 1 in 1,000 of those on the true border, whichever is more, but never more than 3 of
    /// these small pictures.
    static int allow(const std::vector<float>& truth, const Frame& frame) {
        std::size_t border = 0;
        for (std::size_t p = 0; p + 1 < truth.size(); ++p)
            border += (p + 1) % std::size_t(frame.width) != 0 && truth[p] != truth[p + 1];
        return std::min(3, int(std::max(2e-5 * double(truth.size()), 1e-3 * double(border))));
    }

    /// Of both answers there must be at least `least`.
    void expect_true(SceneView view, const Light& light, int least = 100) {
        const RayComparison found = compare_with_rays(runner_, std::move(view), light, "sv");
        EXPECT_GE(found.lit, least);
        EXPECT_GE(found.shadowed, least);
        EXPECT_LE(found.different, allow(found.truth, *found.run.frame));
        lit_ += found.lit, shadowed_ += found.shadowed;
    }
    TechniqueRunner runner_;
    int lit_ = 0, shadowed_ = 0;  ///< of all calls
};

TEST_F(ShadowVolumesTest, EqualRaysOnTangles) {
    for (unsigned seed = 1; seed <= 4; ++seed)
        expect_true(tangle_scene(seed), make_light(kAllLightKinds[seed % 4], {1.5, 1.0, 5.0}, {0, 0, 0.5}, 90));
}

TEST_F(ShadowVolumesTest, EqualExactOnTangles) {
    for (unsigned seed = 5; seed <= 8; ++seed) {
        SceneView view = tangle_scene(seed);
        view.scene->lights = {make_light(kAllLightKinds[seed % 4], {1.5, 1.0, 5.0}, {0, 0, 0.5}, 90)};
        const TechniqueRun volumes = runner_.render(view, "sv"), exact = runner_.render(view, "exact");
        int different = 0;
        for (std::size_t pixel = 0; pixel < exact.visibility().size(); ++pixel)
            different += volumes.visibility()[pixel] != exact.visibility()[pixel];
        EXPECT_LE(different, allow(exact.visibility(), *exact.frame)) << "seed " << seed;
    }
}

TEST_F(ShadowVolumesTest, EqualRaysOnClosedMeshes) {
    for (const LightKind kind : kAllLightKinds) {
        expect_true(random_scene(11, 320, 180), make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80));
        expect_true(tower_scene(320, 180), make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80));
    }
}

TEST_F(ShadowVolumesTest, EqualRaysWithTheLightAmongTheCasters) {
    for (const glm::dvec3& place : {glm::dvec3(0.1, 0.2, 0.9), {0.4, -0.3, 0.25}, {-0.8, 0.5, 1.4}})
        for (const LightKind kind : {LightKind::Point, LightKind::Spot})
            expect_true(tangle_scene(9), make_light(kind, place, {0.3, 0.3, -2}, 150), 0);
}

TEST_F(ShadowVolumesTest, EqualRaysFromAmongTheVolumes) {
    // Low, amid the casters: within volumes, with sides and caps before, beside and behind the camera.
    const glm::dvec3 eyes[] = {{0.2, 0.1, 1.0}, {-0.6, 0.4, 1.2}, {0.9, -0.5, 1.8}};
    for (const glm::dvec3& eye : eyes)
        for (const LightKind kind : {LightKind::Sun, LightKind::Point})
            for (const glm::dvec3& place : {glm::dvec3(3.5, 3.0, 4.0), {-3.5, -2.0, 4.0}}) {  // ahead and behind
                SceneView view = tangle_scene(3, 14);
                view.camera = make_camera(eye, {2.0, 2.5, -0.6}, view.width, view.height, 80);
                view.camera.clip_start = 1e-3;
                expect_true(view, make_light(kind, place, {0, 0, 0.5}), 0);
            }
    EXPECT_GE(lit_, 5000);
    EXPECT_GE(shadowed_, 5000);
}

TEST_F(ShadowVolumesTest, EqualRaysFromInsideAClosedMesh) {
    SceneView view;
    view.width = 320, view.height = 180;
    view.place(view.add("room", make_box({6, 6, 4})), placement({0, 0, 1}));
    view.place(view.add("ball", make_sphere(0.6f)), placement({0.5, 0.8, 0.4}));
    view.camera = make_camera({-2, -2, 1.2}, {0.5, 0.8, 0.2}, view.width, view.height, 70);
    for (const LightKind kind : {LightKind::Point, LightKind::Spot})  // in the room; the room is round all
        expect_true(view, make_light(kind, {-0.5, -0.4, 2.2}, {0.5, 0.8, 0}, 120));
    view.camera = make_camera({0.5, 0.8, 0.4}, {2, 2, 0.0}, view.width, view.height, 70);  // in the ball
    expect_true(view, make_light(LightKind::Point, {0.6, 0.7, 0.5}, {2, 2, 0}), 0);
}

TEST_F(ShadowVolumesTest, EqualRaysWithParallelRays) {
    for (const LightKind kind : kAllLightKinds) {
        SceneView view = tangle_scene(6);
        view.camera.perspective = false;
        view.camera.window = {-3.2, 3.2, -1.8, 1.8};
        expect_true(view, make_light(kind, {1.5, 1.0, 5.0}, {0, 0, 0.5}, 90));
        expect_true(view, make_light(kind, {4.2, -4.4, 4.0}, {0, 0, 0.8}, 90), 0);  // along the view
    }
}

TEST_F(ShadowVolumesTest, EqualRaysWithTheLightAtTheCamera) {
    for (const LightKind kind : {LightKind::Point, LightKind::Spot})
        expect_true(tangle_scene(7), make_light(kind, {4.2, -4.4, 4.0}, {0, 0, 0.8}, 70), 0);
}

TEST_F(ShadowVolumesTest, EqualRaysAtAnyScaleAndPlaceAndMirrored) {
    for (const double scale : {1e-4, 1e5})
        for (const double mirror : {-1.0, 1.0}) {
            SceneView view = random_scene(13, 240, 135);
            const glm::dvec3 place = glm::dvec3(3e5, -7e5, 2e5) * scale;
            const glm::dmat4 move =
                glm::scale(glm::translate(glm::dmat4(1), place), glm::dvec3(mirror * scale, scale, scale));
            for (Instance& instance : view.scene->instances)
                instance.world_from_object = move * instance.world_from_object;
            const auto at = [&](glm::dvec3 p) { return glm::dvec3(move * glm::dvec4(p, 1)); };
            view.camera = make_camera(at({3.6, -3.9, 3.6}), at({0, 0, 0.6}), view.width, view.height);
            view.camera.clip_start *= scale, view.camera.clip_end *= scale;
            for (const LightKind kind : {LightKind::Spot, LightKind::Sun})
                expect_true(view, make_light(kind, at({2, 1.5, 4}), at({0, 0, 0}), 80));
        }
}

TEST_F(ShadowVolumesTest, EqualRaysOnModels) {
    int tried = 0;
    for (const char* name : {"scorpion", "teapot"}) {
        const auto model = load_obj(std::string(SHADOW_LAYERS_SHADER_DIR) + "/../../shared/models/" + name + ".obj");
        if (!model) continue;
        ++tried;
        for (const LightKind kind : {LightKind::Sun, LightKind::Point})
            expect_true(model_scene(*model, 320, 180), make_light(kind, {2, 1.5, 4}, {0, 0, 0.3}, 70));
    }
    if (tried == 0) GTEST_SKIP() << "no ../shared/models";
}

TEST_F(ShadowVolumesTest, CountsMoreVolumesThanAByteHolds) {
    SceneView view;
    view.width = 64, view.height = 48;
    view.place(view.add("plane", make_plane(8)));
    const std::uint32_t sheet = view.add("sheet", make_plane(1));
    for (int k = 0; k < 256; ++k) view.place(sheet, placement({0, 0, 1 + 0.001 * k}));
    view.camera = make_camera({3, -3, 3}, {0, 0, 0}, view.width, view.height);
    expect_true(view, make_light(LightKind::Sun, {0.1, 0.2, 5}, {0, 0, 0}), 20);
}

TEST_F(ShadowVolumesTest, TakesSidesAtSilhouettesOnly) {
    SceneView view = box_scene(64, 36);
    view.scene->lights = {make_light(LightKind::Sun, {2, 1.5, 4}, {0, 0, 0})};
    const auto counters = runner_.render(view, "sv").stats.counters;
    EXPECT_EQ(counters.at("silhouette_edges"), 6 + 4);  // a box's outline, and the plane's rim
    EXPECT_LE(counters.at("volume_quads"), 10);
    EXPECT_LE(counters.at("cap_triangles"), 12 + 2 * 32 * 32);
}

TEST_F(ShadowVolumesTest, AreTheSameForAnyNumberOfThreads) {
    SceneView view = tangle_scene(4);
    view.scene->lights = {make_light(LightKind::Point, {0.4, 0.3, 2.2}, {0, 0, 0})};
    TechniqueRunner one(1), three(3);
    EXPECT_EQ(one.render(view, "sv").visibility(), three.render(view, "sv").visibility());
}

}  // namespace
}  // namespace shadow_layers::testing
