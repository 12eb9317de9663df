// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The exact technique against rays: no pixel may differ, whatever the scene, the light and the number of tiles.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/ray_comparison.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

class Exact : public ::testing::Test {
protected:
    /// Pixels that differ from the rays; of both answers there must be at least so many.
    int count_different(SceneView view, const Light& light, std::int64_t map_size = 1024, int least = 200) {
        const RayComparison found =
            compare_with_rays(runner_, std::move(view), light, "exact", parameters({{"map_size", map_size}}));
        EXPECT_GE(found.lit, least);
        EXPECT_GE(found.shadowed, least);
        EXPECT_LE(std::size_t(found.ties), 1 + found.truth.size() / 20000);
        return found.different;
    }
    TechniqueRunner runner_;
};

TEST_F(Exact, EqualsRaysOnSoups) {
    for (unsigned seed = 1; seed <= 6; ++seed)
        EXPECT_EQ(count_different(make_soup_scene(seed),
                                  make_light(kAllLightKinds[seed % 4], {1.5, 1.0, 5.0}, {0, 0, 0.5}, 90)),
                  0)
            << "seed " << seed;
}

TEST_F(Exact, EqualsRaysOnClosedMeshes) {
    for (const LightKind kind : kAllLightKinds) {
        EXPECT_EQ(count_different(random_scene(11, 400, 225), make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80)), 0);
        SceneView tower = tower_scene(400, 225);
        EXPECT_EQ(count_different(tower, make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80)), 0);
    }
}

TEST_F(Exact, EqualsRaysWithTheLightAmongTheCasters) {
    for (const glm::dvec3& place : {glm::dvec3(0.1, 0.2, 0.9), {0.4, -0.3, 0.25}, {-0.8, 0.5, 1.4}})
        for (const LightKind kind : {LightKind::Point, LightKind::Spot})
            EXPECT_EQ(count_different(make_soup_scene(9), make_light(kind, place, {0.3, 0.3, -2}, 150), 1024, 0), 0);
}

TEST_F(Exact, EqualsRaysUnderStretchedCones) {
    for (const glm::dvec2& scale : {glm::dvec2(2, 0.5), {6, 1}, {0.2, 1}, {1, 40}})
        for (const double angle_deg : {30.0, 90.0, 160.0}) {
            Light light = make_light(LightKind::Spot, {1.5, 1.0, 5.0}, {0, 0, 0.5}, angle_deg);
            light.spot_scale = scale;
            EXPECT_EQ(count_different(random_scene(11, 240, 135), light, 256, 50), 0) << scale.x << " " << angle_deg;
        }
}

TEST_F(Exact, EqualsRaysOnNeedles) {
    for (unsigned seed = 1; seed <= 4; ++seed)
        for (const LightKind kind : kAllLightKinds)
            EXPECT_EQ(count_different(make_needle_scene(seed), make_light(kind, {0.7, 0.4, 3.5}, {0, 0, 0.2}, 100)), 0)
                << "seed " << seed;
}

TEST_F(Exact, EqualsRaysInsideAndOutsideOfAClosedMesh) {
    SceneView view = place_over_plane("sphere", make_sphere(0.9f));
    view.scene->instances.back().world_from_object = placement({0, 0, 1});
    const Light light = make_light(LightKind::Point, {0.2, -0.1, 1.3}, {0, 0, 0});
    const RayComparison outside = compare_with_rays(runner_, view, light, "exact");
    EXPECT_EQ(outside.different, 0);
    EXPECT_EQ(outside.lit, 0) << "the light is shut in";
    EXPECT_GT(outside.shadowed, 10000);
    view.camera = make_camera({-0.3, 0.2, 0.8}, {0.5, -0.2, 1}, view.width, view.height, 100);
    const RayComparison inside = compare_with_rays(runner_, view, light, "exact");
    EXPECT_EQ(inside.different, 0);
    EXPECT_EQ(inside.shadowed, 0) << "a sphere does not shadow itself from inside";
    EXPECT_GT(inside.lit, 10000);
}

TEST_F(Exact, EqualsRaysWhereCastersReachBehindTheLight) {
    const glm::dvec3 place(0.3, 0.2, 2.0);
    for (const double apart : {0.3, 1e-2, 1e-4}) {
        // Walls past the light on two sides, from the floor's level to far behind it, and one across its rear.
        SceneView view = place_over_plane("wall", make_plane(1));
        const auto wall = view.scene->instances.back().mesh;
        view.scene->instances.back().world_from_object =
            placement(place + glm::dvec3(apart, 0, 1), 90, {0, 1, 0}) * glm::scale(glm::dmat4(1), glm::dvec3(3, 1, 1));
        view.place(wall, placement(place + glm::dvec3(0, -2 * apart, 2), 90, {1, 0, 0}) *
                             glm::scale(glm::dmat4(1), glm::dvec3(0.4, 5, 1)));
        view.place(wall, placement(place + glm::dvec3(0, 0, apart)));
        for (const LightKind kind : {LightKind::Point, LightKind::Spot, LightKind::Area})
            EXPECT_EQ(count_different(view, make_light(kind, place, {0.3, 0.2, 0}, 140), 1024, 100), 0) << apart;
    }
}

TEST_F(Exact, EqualsRaysInTheSmallestPictures) {
    for (const auto& [width, height] : {std::pair(1, 1), {1, 9}, {23, 1}, {2, 2}})
        for (const LightKind kind : kAllLightKinds)
            EXPECT_EQ(count_different(random_scene(16, width, height), make_light(kind, {2, 1.5, 4}, {0, 0, 0}), 64, 0),
                      0)
                << width << " x " << height;
}

TEST_F(Exact, WithoutCastersAllThatIsTurnedToTheLightIsLit) {
    for (const LightKind kind : kAllLightKinds) {
        SceneView view = random_scene(17, 160, 90);
        view.place(view.add("nothing", {}));
        for (Instance& instance : view.scene->instances) instance.flags = kInstanceCamera;
        const RayComparison found =
            compare_with_rays(runner_, view, make_light(kind, {2, 1.5, 4}, {0, 0, 0}, 120), "exact");
        EXPECT_EQ(found.different, 0);
        EXPECT_EQ(found.shadowed, 0);
        EXPECT_GT(found.lit, 1000);
    }
}

TEST_F(Exact, DoesNotDependOnTheNumberOfTiles) {
    for (const std::int64_t size : {1, 7, 64, 256, 4096})
        EXPECT_EQ(
            count_different(random_scene(12, 240, 135), make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0}), size), 0)
            << size;
}

TEST_F(Exact, EqualsRaysAtAnyScaleAndPlace) {
    for (const double scale : {1e-4, 1.0, 1e5, 1e6})
        for (const glm::dvec3& place : {glm::dvec3(0), {3e5, -7e5, 2e5}}) {
            SceneView view = random_scene(13, 240, 135);
            const glm::dmat4 move = glm::scale(glm::translate(glm::dmat4(1), place * scale), glm::dvec3(scale));
            for (Instance& instance : view.scene->instances)
                instance.world_from_object = move * instance.world_from_object;
            const auto at = [&](glm::dvec3 p) { return glm::dvec3(move * glm::dvec4(p, 1)); };
            view.camera = make_camera(at({3.6, -3.9, 3.6}), at({0, 0, 0.6}), view.width, view.height);
            view.camera.clip_start *= scale, view.camera.clip_end *= scale;
            for (const LightKind kind : {LightKind::Spot, LightKind::Sun})
                EXPECT_EQ(count_different(view, make_light(kind, at({2, 1.5, 4}), at({0, 0, 0}), 80)), 0) << scale;
        }
}

TEST_F(Exact, EqualsRaysOnModels) {
    int tried = 0;
    for (const char* name : {"scorpion", "bunny_hr", "armadillo", "teapot"}) {
        const auto model = load_obj(std::string(SHADOW_LAYERS_SHADER_DIR) + "/../../shared/models/" + name + ".obj");
        if (!model) continue;
        ++tried;
        for (const LightKind kind : kAllLightKinds)
            EXPECT_EQ(count_different(model_scene(*model, 480, 270), make_light(kind, {2, 1.5, 4}, {0, 0, 0.3}, 70)), 0)
                << name;
    }
    if (tried == 0) GTEST_SKIP() << "no ../shared/models";
}

/// The raster's grid gives some pixels to the triangle next to the one that their ray meets. In a hollow their points
/// would lie beneath that one, and in its shadow.
TEST_F(Exact, EqualsRaysThatFindTheTrianglesThemselves) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        SceneView view;
        view.width = 640, view.height = 360;
        view.place(view.add("plane", make_plane(12)));
        view.place(view.add("ball", make_rough_ball(seed, 1, 0.02f)), placement({0, 0, 1.1}));
        view.camera = make_camera({2.4, -2.6, 2.0}, {0, 0, 1}, view.width, view.height);
        for (const LightKind kind : kAllLightKinds) {
            const RayComparison found =
                compare_with_eye_rays(runner_, view, make_light(kind, {2, 1.5, 4}, {0, 0, 0.5}, 80), "exact");
            EXPECT_GE(std::min(found.lit, found.shadowed), 2000);
            EXPECT_EQ(found.different, 0) << "seed " << seed;
        }
    }
}

TEST_F(Exact, IsTheSameForAnyNumberOfThreads) {
    TechniqueRunner one(1), three(3), eight(8);
    for (SceneView view : {make_soup_scene(4), random_scene(15, 320, 180), make_needle_scene(2)}) {
        view.scene->lights = {make_light(LightKind::Point, {0.4, 0.3, 2.2}, {0, 0, 0})};
        const auto expected = one.render(view, "exact");
        for (TechniqueRunner* runner : {&three, &eight})
            for (int again = 0; again < 3; ++again)
                EXPECT_EQ(runner->render(view, "exact").visibility(), expected.visibility());
    }
}

TEST_F(Exact, SettlesFewPairsInDouble) {
    SceneView view = random_scene(14, 640, 360);
    view.scene->lights = {make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0})};
    const auto counters = runner_.render(view, "exact").stats.counters;
    EXPECT_GT(counters.at("tile_tests"), 10000);
    EXPECT_LT(counters.at("open_pairs"), counters.at("receivers") / 50);
}

}  // namespace
}  // namespace shadow_layers::testing
