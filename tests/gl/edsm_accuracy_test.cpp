// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// edsm against exact rays: its wrong pixels as a share of sm's, and what its parameters must do.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/ray_comparison.h"

namespace shadow_layers::testing {
namespace {

class EDSMTest : public ::testing::Test {
protected:
    ShadowErrors errors_of(const SceneView& view, const std::string& technique, ParameterValues values,
                           std::int64_t map_size) {
        values.set("map_size", map_size);
        return find_shadow_errors(runner_, view, technique, values);
    }
    void expect_ratio(const SceneView& view, std::int64_t map_size, double ratio, double plane_ratio) {
        const ShadowErrors sm = errors_of(view, "sm", {}, map_size), edsm = errors_of(view, "edsm", {}, map_size);
        ASSERT_GT(sm.wrong_ppm, 100) << "the scene tells nothing";
        EXPECT_LE(edsm.wrong_ppm, ratio * sm.wrong_ppm) << "sm " << sm.wrong_ppm << " ppm";
        EXPECT_LE(edsm.plane_wrong_ppm, plane_ratio * sm.plane_wrong_ppm) << "sm " << sm.plane_wrong_ppm << " ppm";
        for (const ShadowErrors& errors : {sm, edsm}) {
            EXPECT_LE(errors.acne_ppm, 500);
            EXPECT_LE(errors.leak_ppm, 500);
        }
    }
    TechniqueRunner runner_;
};

const glm::dvec3 kLamp(1.2, 2.6, 4.6), kAim(0, 0, 0.4);

TEST_F(EDSMTest, BoxIsAlmostExactUnderEveryLight) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        SCOPED_TRACE(int(kind));
        SceneView view = box_scene(640, 360);
        view.scene->lights = {make_light(kind, kLamp, kAim)};
        expect_ratio(view, 512, 0.02, 0.02);
    }
}

TEST_F(EDSMTest, BevelledTower) {
    SceneView view = tower_scene(640, 360);
    view.scene->lights = {make_light(LightKind::Spot, kLamp, kAim)};
    expect_ratio(view, 1024, 0.15, 0.1);
    view.scene->lights = {make_light(LightKind::Sun, kLamp, kAim)};
    expect_ratio(view, 1024, 0.15, 0.1);
}

TEST_F(EDSMTest, RandomBoxesAndBalls) {
    for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
        SCOPED_TRACE(seed);
        SceneView view = random_scene(seed, 480, 270);
        view.scene->lights = {make_light(seed % 2 ? LightKind::Spot : LightKind::Point, kLamp, kAim, 70)};
        expect_ratio(view, 512, 0.08, 0.05);
    }
}

TEST_F(EDSMTest, Scorpion) {
    const auto model = load_obj(std::string(SHADOW_LAYERS_SHADER_DIR) + "/../../shared/models/scorpion.obj");
    if (!model) GTEST_SKIP() << "no ../shared/models";
    SceneView view = model_scene(*model, 640, 360);
    view.scene->lights = {make_light(LightKind::Spot, kLamp, kAim)};
    expect_ratio(view, 1024, 0.5, 0.2);
}

TEST_F(EDSMTest, OpenAndNonManifoldCasters) {
    SceneView view;
    view.width = 480, view.height = 270;
    view.place(view.add("ground", make_plane(10)));
    // A sheet, a fan of three sheets on one edge, and triangles whose windings disagree.
    MeshData fan{{{-0.6f, 0, 0},
                  {0.6f, 0, 0},
                  {0.6f, 0.7f, 0.2f},
                  {-0.6f, 0.7f, 0.2f},
                  {0.6f, -0.5f, 0.3f},
                  {-0.6f, -0.5f, 0.3f},
                  {0.6f, 0.1f, 0.8f},
                  {-0.6f, 0.1f, 0.8f}},
                 {{0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {0, 5, 4}, {0, 1, 6}, {7, 6, 0}}};
    view.place(view.add("fan", fan), placement({-0.9, 0.1, 1.0}, 25));
    view.place(view.add("sheet", make_plane(1, 3)), placement({0.9, 0.3, 1.3}, 50, {1, 0.2, 0.1}));
    MeshData twisted = make_box({0.8f, 0.6f, 0.7f});
    for (std::size_t k = 0; k < twisted.triangles.size(); k += 3)
        std::swap(twisted.triangles[k].y, twisted.triangles[k].z);
    view.place(view.add("twisted", twisted), placement({0.3, -1.1, 0.9}, 33, {0.2, 0.4, 1}));
    view.camera = make_camera({3.4, -3.6, 3.2}, {0, 0.2, 0.3}, view.width, view.height);
    view.scene->lights = {make_light(LightKind::Spot, kLamp, kAim)};
    expect_ratio(view, 512, 0.05, 0.05);
}

TEST_F(EDSMTest, OrdersRankAsInTheThesisFigures) {
    SceneView view = tower_scene(640, 360);
    view.scene->lights = {make_light(LightKind::Spot, kLamp, kAim)};
    std::map<std::string, double> wrong;
    for (const char* order : {"stream", "min", "thesis", "corrected"})
        wrong[order] = errors_of(view, "edsm", parameters({{"edge_order", std::string(order)}}), 512).plane_wrong_ppm;
    EXPECT_LT(wrong["corrected"], 0.8 * wrong["stream"]);  // figure 3.6 against 3.9
    EXPECT_LT(wrong["corrected"], wrong["min"]);           // figure 3.7
    EXPECT_LE(wrong["corrected"], 1.2 * wrong["thesis"]);  // figure 3.8
}

TEST_F(EDSMTest, TheThesisReadingIsExactOnABoxButForCornersAndBias) {
    SceneView view = box_scene(640, 360);
    view.scene->lights = {make_light(LightKind::Spot, kLamp, kAim)};
    const auto thesis = errors_of(
        view, "edsm", parameters({{"reading", std::string("thesis")}, {"edge_order", std::string("thesis")}}), 512);
    const auto sm = errors_of(view, "sm", {}, 512), improved = errors_of(view, "edsm", {}, 512);
    EXPECT_LT(thesis.wrong_ppm, 0.5 * sm.wrong_ppm);
    EXPECT_LE(improved.wrong_ppm, thesis.wrong_ppm);
}

TEST_F(EDSMTest, PerspectiveQuadsGetNarrowerWithDistance) {
    SceneView view = tower_scene(320, 180);
    view.scene->lights = {make_light(LightKind::Spot, kLamp, kAim)};
    const auto wide = runner_.render(view, "edsm", parameters({{"quads", std::string("post_projective")}}));
    const auto narrow = runner_.render(view, "edsm", parameters({{"quads", std::string("perspective")}}));
    EXPECT_EQ(wide.stats.counters.at("edge_quads"), narrow.stats.counters.at("edge_quads"));
    EXPECT_LT(narrow.stats.counters.at("edge_fragments"), wide.stats.counters.at("edge_fragments"));
}

TEST_F(EDSMTest, SoftBordersKeepTheirPlaceAndHaveTheWidthAsked) {
    SceneView view;
    view.width = 512, view.height = 9;
    view.place(view.add("ground", make_plane(8)));
    view.place(view.add("half", make_plane(8)), placement({4.0131, 0, 1}), kInstanceShadow);
    view.camera = make_camera({0, 0, 10}, {0, 0, 0}, view.width, view.height, 12);
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0})};
    for (const double softness : {1.0, 2.0, 5.0, 16.0}) {
        const auto run =
            runner_.render(view, "edsm", parameters({{"map_size", std::int64_t{256}}, {"softness", softness}}));
        const auto& values = run.visibility();
        const auto& places = run.frame->positions_rel;
        const double texel =
            2.0 / std::abs(run.positions[0].views[0].lc_from_ws[0][0]) / run.positions[0].views[0].size_texels;
        double worst = 0;
        for (int x = 0; x < view.width; ++x) {
            const std::size_t pixel = std::size_t(4 * view.width + x);
            // Lit part of a disc of that width, cut by the border at x = 0.0131.
            const double d = std::clamp(2 * (0.0131 - places[pixel].x) / texel / softness, -1.0, 1.0);
            const double wanted = 0.5 + (d * std::sqrt(1 - d * d) + std::asin(d)) / std::acos(-1.0);
            worst = std::max(worst, std::abs(values[pixel] - wanted));
        }
        EXPECT_LT(worst, 0.02) << softness;
    }
}

TEST_F(EDSMTest, SoftBordersReachOverTheSeamsOfACube) {
    // The light is 5 above the ground, so the face below it ends at x = 5; the shadow begins a few texels beyond.
    const double border = 5.06;
    SceneView view;
    view.width = 512, view.height = 9;
    view.place(view.add("ground", make_plane(40)));
    view.place(view.add("half", make_plane(8)), placement({0.8 * border + 4, 0, 1}), kInstanceShadow);
    view.camera = make_camera({5, 0, 10}, {5, 0, 0}, view.width, view.height, 10);
    view.scene->lights = {make_light(LightKind::Point, {0, 0, 5}, {0, 0, 0})};
    const double softness = 12;
    const auto run = runner_.render(view, "edsm", parameters({{"map_size", std::int64_t{64}}, {"softness", softness}}));
    const auto& maps = run.positions[0].views;
    const auto below = std::find_if(maps.begin(), maps.end(), [](const LightView& map) { return map.face == 5; });
    ASSERT_NE(below, maps.end());
    const double texel = 5 * 2.0 / std::abs(below->lc_from_ws[0][0]) / below->size_texels;
    ASSERT_GT(border - 5, 3 * texel) << "the border is on the rim's own texels";
    ASSERT_LT(border - 5, 0.4 * softness * texel) << "the ramp does not reach the seam";
    int soft = 0;
    for (int x = 0; x < view.width; ++x) {
        const std::size_t pixel = std::size_t(4 * view.width + x);
        const double place = run.frame->positions_rel[pixel].x + run.frame->origin_ws.x;
        if (place > 4.999) continue;
        const double d = std::clamp(2 * (border - place) / texel / softness, -1.0, 1.0);
        const double wanted = 0.5 + (d * std::sqrt(1 - d * d) + std::asin(d)) / std::acos(-1.0);
        soft += wanted < 0.98;
        ASSERT_NEAR(run.visibility()[pixel], wanted, 0.02) << place;
    }
    EXPECT_GT(soft, 2);
}

TEST_F(EDSMTest, SoftEdgesInsideAShadowLetNoLightThrough) {
    // The small plate's outline is seen from the light, but the large plate under it darkens both its sides on the
    // ground.
    SceneView view;
    view.width = 96, view.height = 54;
    view.place(view.add("ground", make_plane(8)));
    view.place(view.add("large", make_plane(4)), placement({0, 0, 1}), kInstanceShadow);
    view.place(view.add("small", make_plane(1)), placement({0, 0, 2}, 20), kInstanceShadow);
    view.camera = make_camera({0, 0, 10}, {0, 0, 0}, view.width, view.height, 16);
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0})};
    const auto run = runner_.render(view, "edsm", parameters({{"map_size", std::int64_t{128}}, {"softness", 6.0}}));
    ASSERT_GE(run.stats.counters.at("edge_quads"), 4);
    for (const float v : run.visibility()) ASSERT_EQ(v, 0);
}

TEST_F(EDSMTest, CountersTellTheWork) {
    SceneView view = box_scene(160, 90);
    view.scene->lights = {make_light(LightKind::Spot, kLamp, kAim)};
    const auto run = runner_.render(view, "edsm");
    const auto& counters = run.stats.counters;
    // A box seen from a general point has six outline edges; the plane adds its four boundary edges, of which the view
    // may cut away all.
    EXPECT_EQ(counters.at("silhouette_edges"), 10);
    EXPECT_GE(counters.at("edge_quads"), 6);
    EXPECT_LE(counters.at("edge_quads"), 10);
    EXPECT_GT(counters.at("edge_fragments"), 0);
    const auto again = runner_.render(view, "edsm");  // from the cache
    for (const char* name : {"silhouette_edges", "edge_quads", "edge_fragments"})
        EXPECT_EQ(again.stats.counters.at(name), counters.at(name)) << name;
}

}  // namespace
}  // namespace shadow_layers::testing
