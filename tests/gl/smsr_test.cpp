// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// smsr, smsr2 and rsmss as layers: straight borders on flat, sloped and curved receivers, over cube faces, and the two
// ways to the same picture. Their rules have tests of their own (revectorisation_lib_test.cpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/ray_oracle.h"
#include "support/shadow_errors.h"
#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

struct Variant {
    std::string technique;
    ParameterValues parameters;
};

ParameterValues with_mode(const char* mode) { return parameters({{"mode", std::string(mode)}}); }

/// A half-plane high over a ground that rises along y, mainly, under a sun from straight above: the shadow's border is
/// the line (cos turn, sin turn) . (x, y) = 0.0131, whatever the tilt.
struct EdgeScene {
    SceneView view;
    glm::dvec2 normal;
};

EdgeScene make_edge_scene(double tilt_deg, double turn_deg) {
    EdgeScene scene;
    SceneView& view = scene.view;
    view.width = 480, view.height = 270;
    const double turn = glm::radians(turn_deg);
    scene.normal = {std::cos(turn), std::sin(turn)};
    view.place(view.add("ground", make_plane(14)), placement({0, 0, 0}, tilt_deg, {1, -0.2, 0}));
    view.place(view.add("half", make_plane(12)), placement(glm::dvec3(scene.normal * 6.0131, 5), turn_deg),
               kInstanceShadow);
    view.camera = make_camera({0, 0, 12}, {0, 0, 0}, view.width, view.height, 16);
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 9}, {0, 0, 0})};
    return scene;
}

/// Of the pixels within a texel of the true border, the part on the wrong side; and how many are wrong farther off.
struct BorderErrors {
    double near = 0, shift = 0;
    int far = 0;
};

class RevectorisedTest : public ::testing::Test {
protected:
    BorderErrors measure(const EdgeScene& scene, const std::string& technique, ParameterValues values) {
        values.set("map_size", std::int64_t{192});
        const auto run = runner_.render(scene.view, technique, values);
        const LightView& map = run.positions[0].views[0];
        const double texel = 2.0 / std::abs(map.lc_from_ws[0][0]) / map.size_texels;
        BorderErrors errors;
        int band = 0;
        for (std::size_t pixel = 0; pixel < run.visibility().size(); ++pixel) {
            const glm::dvec3 at = glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws;
            const double distance = (glm::dot(scene.normal, glm::dvec2(at)) - 0.0131) / texel;  // into the shadow
            const float truth = distance > 0 ? 0.0f : 1.0f, found = run.visibility()[pixel];
            const bool wrong = (found >= 0.5f) != (truth >= 0.5f);
            if (std::abs(distance) > 1.5) errors.far += found != truth;
            if (std::abs(distance) > 1) continue;
            ++band;
            errors.near += wrong;
            errors.shift += 2 * (truth - found);
        }
        EXPECT_GT(band, 300);
        errors.near /= band;
        errors.shift /= band;
        return errors;
    }
    TechniqueRunner runner_;
};

TEST_F(RevectorisedTest, StraightBordersLoseTheirStepsOnAnySlope) {
    for (const double tilt : {0.0, 35.0, 65.0})
        for (const double turn : {9.0, 15.0}) {
            SCOPED_TRACE(::testing::Message() << "tilt " << tilt << " turn " << turn);
            const EdgeScene scene = make_edge_scene(tilt, turn);
            const auto sm = measure(scene, "sm", {}), smsr = measure(scene, "smsr", {}),
                       half = measure(scene, "smsr", with_mode("half")), rsmss = measure(scene, "rsmss", {});
            EXPECT_GT(sm.near, 0.09);
            EXPECT_LT(half.near, 0.045);
            EXPECT_LT(rsmss.near, 0.045);
            EXPECT_NEAR(smsr.shift, 0.5, 0.08);  // half a texel of shadow added, as it is defined
            EXPECT_NEAR(half.shift, 0.0, 0.06);
            EXPECT_NEAR(rsmss.shift, 0.0, 0.06);
            for (const BorderErrors& errors : {smsr, half, rsmss}) EXPECT_EQ(errors.far, 0);
        }
}

TEST_F(RevectorisedTest, TheSlopeRuleIsWhatKeepsWalksWhole) {
    ParameterValues without = with_mode("half");
    without.set("epsilon_rule", false);
    const EdgeScene flat = make_edge_scene(0, 4), steep = make_edge_scene(50, 4);
    EXPECT_NEAR(measure(flat, "smsr", without).near, measure(flat, "smsr", with_mode("half")).near, 1e-9);
    EXPECT_GT(measure(steep, "smsr", without).near, 2 * measure(steep, "smsr", with_mode("half")).near);
}

TEST_F(RevectorisedTest, LongerWalksStraightenFlatterBorders) {
    const EdgeScene scene = make_edge_scene(0, 1.2);  // steps of about 48 texels
    double last = 1;
    for (const std::int64_t limit : {4, 16, 64}) {
        ParameterValues values = with_mode("half");
        values.set("walk_limit", limit);
        const double wrong = measure(scene, "smsr", values).near;
        EXPECT_LT(wrong, last) << limit;
        last = wrong;
    }
    EXPECT_LT(last, 0.04);
}

TEST_F(RevectorisedTest, PlanesDoNotShadeThemselves) {
    for (const double slope_deg : {0.0, 60.0, 88.0}) {
        SceneView view;
        view.width = 128, view.height = 72;
        view.place(view.add("plane", make_plane(8, 5)), placement({0, 0, 0}, slope_deg, {0.3, 1, 0}));
        view.camera = make_camera({-2, -3, 5}, {0, 0, 0}, view.width, view.height);
        for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point}) {
            view.scene->lights = {make_light(kind, {0.01, 0.02, 6}, {0, 0, 0}, 100)};
            const ParameterValues map = parameters({{"map_size", std::int64_t{128}}});
            const auto sm = runner_.render(view, "sm", map);  // lit all over, but where the plane is turned away
            for (const char* technique : {"smsr", "smsr2", "rsmss"}) {
                const auto run = runner_.render(view, technique, map);
                int darker = 0;
                for (std::size_t pixel = 0; pixel < sm.visibility().size(); ++pixel)
                    darker += run.visibility()[pixel] < sm.visibility()[pixel];
                EXPECT_EQ(darker, 0) << technique << " slope " << slope_deg << " kind " << int(kind);
            }
        }
    }
}

TEST_F(RevectorisedTest, CurvedReceiversComeNearerToTheTruthThanTheShadowMap) {
    SceneView view;
    view.width = 320, view.height = 180;
    view.place(view.add("ball", make_sphere(1.0f, 96, 192)));
    for (int k = -3; k <= 3; ++k)  // slats, whose shadows run slanting over the ball
        view.place(view.add("slat", make_plane(1)), glm::scale(placement({0.5 * k, 0, 2.5}, 7), glm::dvec3(0.22, 6, 1)),
                   kInstanceShadow);
    view.camera = make_camera({1.2, -2.2, 3.2}, {0, 0, 0.2}, view.width, view.height, 36);
    view.scene->lights = {make_light(LightKind::Spot, {0.3, 0.4, 6}, {0, 0, 0}, 50)};
    const RayOracle oracle(view.scene);
    const ParameterValues map = parameters({{"map_size", std::int64_t{256}}});
    const auto wrong = [&](const std::string& technique, ParameterValues values) {
        values.set("map_size", std::int64_t{256});
        const auto run = runner_.render(view, technique, values);
        const auto truth = oracle.compute_visibility(*run.frame, view.scene->lights[0], run.positions[0]);
        return measure_shadow_errors(*run.frame, view.scene->lights[0], run.positions[0], truth, run.visibility());
    };
    const auto sm = wrong("sm", {});
    for (const auto& better : {wrong("smsr", with_mode("half")), wrong("rsmss", {})}) {
        EXPECT_LT(better.wrong_ppm, 0.75 * sm.wrong_ppm);
        EXPECT_LE(better.acne_ppm, sm.acne_ppm + 100);
        EXPECT_LE(better.leak_ppm, sm.leak_ppm + 100);
    }
    EXPECT_LT(wrong("smsr", {}).wrong_ppm, 2.5 * sm.wrong_ppm);  // half a texel of shadow is added
}

TEST_F(RevectorisedTest, BordersCrossCubeFacesWithoutASeam) {
    // The border of a half-plane's shadow runs slanting over the rim between two faces of a point light's cube, in
    // steps of tens of texels: each is whole only if walks see beyond the rim.
    SceneView view;
    view.width = 480, view.height = 270;
    view.place(view.add("ground", make_plane(30)));
    view.place(view.add("half", make_plane(12)), placement({0, 6, 1}, 3.3), kInstanceShadow);
    view.camera = make_camera({3, -5, 8}, {3, 0.5, 0}, view.width, view.height, 50);
    const glm::dvec3 place(0.11, -0.17, 3);
    view.scene->lights = {make_light(LightKind::Point, place, {1, 0.4, 0.2})};
    const RayOracle oracle(view.scene);
    for (const Variant& variant : {Variant{"smsr", with_mode("half")}, {"smsr2", with_mode("half")}, {"rsmss", {}}}) {
        ParameterValues values = variant.parameters;
        values.set("map_size", std::int64_t{64});
        values.set("walk_limit", std::int64_t{64});
        const auto run = runner_.render(view, variant.technique, values);
        const auto truth = oracle.compute_visibility(*run.frame, view.scene->lights[0], run.positions[0]);
        double wrong[2] = {0, 0}, border[2] = {0, 0};
        for (int y = 0; y + 1 < view.height; ++y)
            for (int x = 0; x < view.width; ++x) {
                const std::size_t pixel = std::size_t(y * view.width + x);
                const glm::dvec3 at = glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws;
                const bool at_rim = std::abs(std::abs(at.x - place.x) / place.z - 1.0) < 0.25;
                wrong[at_rim] += (truth[pixel] >= 0.5f) != (run.visibility()[pixel] >= 0.5f);
                border[at_rim] += truth[pixel] != truth[pixel + std::size_t(view.width)];
            }
        ASSERT_GT(border[0], 50);
        ASSERT_GT(border[1], 25);
        EXPECT_LT(wrong[1] / border[1], 1.5 * wrong[0] / border[0] + 0.1) << variant.technique;
        EXPECT_LT(wrong[0] / border[0], 0.3) << variant.technique;  // the ground falls away steeply on the second face
    }
}

TEST_F(RevectorisedTest, TwoPassesGiveThePictureOfOne) {
    const auto differences = [&](const SceneView& view, ParameterValues values) {
        values.set("map_size", std::int64_t{256});
        const auto one = runner_.render(view, "smsr", values), two = runner_.render(view, "smsr2", values);
        double count = 0;
        for (std::size_t pixel = 0; pixel < one.visibility().size(); ++pixel)
            count += one.visibility()[pixel] != two.visibility()[pixel];
        return count / double(one.visibility().size());
    };
    for (const char* mode : {"paper", "reduced", "half"}) {
        // One flat receiver far below its caster: every pixel answers alike for a texel.
        EXPECT_EQ(differences(make_edge_scene(0, 5).view, with_mode(mode)), 0) << mode;
        EXPECT_EQ(differences(make_edge_scene(40, 5).view, with_mode(mode)), 0) << mode;
        for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
            SceneView view = random_scene(4, 240, 135);
            view.scene->lights = {make_light(kind, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 70)};
            EXPECT_LT(differences(view, with_mode(mode)), 0.002) << mode;
        }
    }
}

TEST_F(RevectorisedTest, TheThresholdCutsTheRampAtOneHalf) {
    SceneView view = random_scene(6, 160, 90);
    view.scene->lights = {make_light(LightKind::Spot, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 70)};
    const ParameterValues map = parameters({{"map_size", std::int64_t{128}}});
    ParameterValues cut = map;
    cut.set("threshold", true);
    const auto smooth = runner_.render(view, "rsmss", map).visibility(),
               hard = runner_.render(view, "rsmss", cut).visibility();
    int between = 0;
    for (std::size_t pixel = 0; pixel < smooth.size(); ++pixel) {
        between += smooth[pixel] > 0 && smooth[pixel] < 1;
        ASSERT_EQ(hard[pixel], smooth[pixel] >= 0.5f ? 1.0f : 0.0f);
    }
    EXPECT_GT(between, 300);
}

}  // namespace
}  // namespace shadow_layers::testing
