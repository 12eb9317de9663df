// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// That edsm's wrong pixels are given the right cause: on scenes in which only one is possible.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "lights/facing.h"
#include "support/edsm_examiner.h"

namespace shadow_layers::testing {
namespace {

class EDSMCausesTest : public ::testing::Test {
protected:
    /// Plates in the sun over a ground that the camera sees alone, from straight above. At `map_size` 64 a texel is
    /// about an eighth of a unit.
    SceneView ground_view() {
        SceneView view;
        view.width = view.height = 512;
        view.place(view.add("ground", make_plane(20)));
        view.camera = make_camera({0.02, 0.01, 12}, {0.02, 0.01, 0}, view.width, view.height, 36);
        view.scene->lights = {make_light(LightKind::Sun, {0.3, 0.2, 5}, {0, 0, 0})};
        return view;
    }
    EDSMCauses count(const SceneView& view, std::int64_t map_size = 64) {
        const truth::RayOracle oracle(view.scene);
        const EDSMCauses causes = count_edsm_causes(runner_, view, oracle, parameters({{"map_size", map_size}}));
        EXPECT_GT(causes.compared, 100000u) << "most of the picture is decided by the casters";
        EXPECT_EQ(causes.not_replayed, 0u) << "the replay is not the technique";
        return causes;
    }
    static std::string tell(const EDSMCauses& causes) {
        std::string text = std::to_string(causes.wrong) + " wrong:";
        for (int k = 0; k < kEDSMCauseCount; ++k)
            if (causes.by_cause[std::size_t(k)])
                text +=
                    std::string(" ") + get_name(EDSMCause(k)) + " " + std::to_string(causes.by_cause[std::size_t(k)]);
        return text;
    }
    /// All wrong pixels have one of these causes, and each of these occurs.
    static void expect_only(const EDSMCauses& causes, std::initializer_list<EDSMCause> wanted) {
        std::size_t sum = 0;
        for (const EDSMCause cause : wanted) {
            EXPECT_GT(causes.count(cause), 0u) << get_name(cause) << "; " << tell(causes);
            sum += causes.count(cause);
        }
        EXPECT_EQ(sum, causes.wrong) << tell(causes);
    }
    TechniqueRunner runner_;
};

constexpr std::uint32_t kCasts = kInstanceShadow;

TEST_F(EDSMCausesTest, TheReplayIsTheTechniqueOnWholePictures) {
    std::vector<SceneView> scenes{random_scene(4, 320, 180), tower_scene(320, 180)};
    for (SceneView& view : scenes)
        for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point})
            for (const std::int64_t size : {64, 512}) {
                SCOPED_TRACE(std::to_string(int(kind)) + ", " + std::to_string(size));
                view.scene->lights = {make_light(kind, {1.2, 2.6, 4.6}, {0, 0, 0.4})};
                const Light& light = view.scene->lights[0];
                const ParameterValues values = parameters({{"map_size", size}});
                const auto run = runner_.render(view, "edsm", values);
                const truth::RayOracle oracle(view.scene);
                const EDSMExaminer examiner(runner_, run, values, light, oracle);
                const FacingRule facing(*run.frame, light, run.positions[0]);
                int lit = 0, dark = 0, different = 0;
                for (std::size_t pixel = 0; pixel < run.visibility().size(); ++pixel) {
                    if (facing.classify(pixel) != Facing::Undecided) continue;
                    const bool is_lit = run.visibility()[pixel] >= 0.5f;
                    ++(is_lit ? lit : dark);
                    different += examiner.replay(pixel) != is_lit;
                }
                EXPECT_GT(lit, 5000);
                EXPECT_GT(dark, 500);
                EXPECT_LE(different, 2);  // float against double, in a tie
            }
}

TEST_F(EDSMCausesTest, WhatIsNotReplayedIsRefused) {
    const SceneView view = ground_view();
    const truth::RayOracle oracle(view.scene);
    EXPECT_THROW(count_edsm_causes(runner_, view, oracle, parameters({{"softness", 2.0}})), std::invalid_argument);
    EXPECT_THROW(count_edsm_causes(runner_, view, oracle, parameters({{"reading", std::string("thesis")}})),
                 std::invalid_argument);
}

TEST_F(EDSMCausesTest, AStraightEdgeLeavesRoundingAlone) {
    SceneView view = ground_view();
    view.place(view.add("plate", make_plane(40)), placement({0.013, 0.7, 1}, 17) * placement({20, 0, 0}), kCasts);
    const EDSMCauses causes = count(view);
    EXPECT_LE(causes.wrong, 3u) << tell(causes);  // places on the border, to a float
    EXPECT_EQ(causes.count(EDSMCause::Rounding), causes.wrong) << tell(causes);
}

TEST_F(EDSMCausesTest, ACornerIsACorner) {
    SceneView view = ground_view();
    // Hexagons of some texels, so that corners lie anywhere between centres. Corners as blunt as these seldom have both
    // their edges in a footprint without the vertex, or lie between the centres.
    MeshData hexagon;
    for (int k = 0; k < 6; ++k) {
        const double angle = std::acos(-1.0) / 3 * k;
        hexagon.positions.push_back({0.8f * float(std::cos(angle)), 0.8f * float(std::sin(angle)), 0});
        if (k > 1) hexagon.triangles.push_back({0u, std::uint32_t(k - 1), std::uint32_t(k)});
    }
    const auto tile = view.add("tile", hexagon);
    for (int k = 0; k < 9; ++k)
        view.place(tile, placement({2.3 * (k % 3) - 2.3, 2.4 * (k / 3) - 2.4, 1}, 13 * k), kCasts);
    const EDSMCauses causes = count(view);
    EXPECT_GT(causes.count(EDSMCause::Corner), 2 * causes.wrong / 3) << tell(causes);
    EXPECT_EQ(causes.count(EDSMCause::Corner) + causes.count(EDSMCause::TwoEdges) +
                  causes.count(EDSMCause::BelowTexel) + causes.count(EDSMCause::Rounding),
              causes.wrong)
        << tell(causes);
}

TEST_F(EDSMCausesTest, AWireIsBelowATexel) {
    SceneView view = ground_view();
    // A twentieth of a texel wide: hardly a centre is covered.
    view.place(view.add("wire", make_box({40, 0.006f, 0.006f})), placement({0.1, 0.2, 1}, 25), kCasts);
    const EDSMCauses causes = count(view);
    EXPECT_GT(causes.count(EDSMCause::BelowTexel), 5 * causes.count(EDSMCause::TwoEdges)) << tell(causes);
    EXPECT_EQ(causes.count(EDSMCause::BelowTexel) + causes.count(EDSMCause::TwoEdges), causes.wrong) << tell(causes);
}

TEST_F(EDSMCausesTest, TwoEdgesInATexel) {
    SceneView view = ground_view();
    // A slit of half a texel between two plates, at an angle, so that it passes over some centres and between others.
    const auto plate = view.add("plate", make_plane(40));
    view.place(plate, placement({0, 0, 1}, 25) * placement({-20.03, 0, 0}), kCasts);
    view.place(plate, placement({0, 0, 1}, 25) * placement({20.03, 0, 0}), kCasts);
    const EDSMCauses causes = count(view);
    EXPECT_GT(causes.count(EDSMCause::TwoEdges), causes.count(EDSMCause::BelowTexel)) << tell(causes);
    expect_only(causes, {EDSMCause::TwoEdges, EDSMCause::BelowTexel});
}

TEST_F(EDSMCausesTest, WhereSurfacesCutEachOtherThereIsNoEdge) {
    SceneView view = ground_view();
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0})};
    // A slope through the ground: its shadow begins where it rises above it.
    view.place(view.add("slope", make_plane(40)), placement({0.1, 0.2, 0}, 25) * placement({0, 0, 0}, 30, {0, 1, 0}),
               kCasts);
    const EDSMCauses causes = count(view);
    expect_only(causes, {EDSMCause::Meeting, EDSMCause::DepthTest});
}

TEST_F(EDSMCausesTest, AnEdgeInsideAnothersShadow) {
    SceneView view = ground_view();
    // The upper plate ends a fifth of a texel inside the lower one's shadow: its edge is seen from the light, is the
    // nearest of many texels, and borders nothing.
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0})};
    const auto plate = view.add("plate", make_plane(40));
    view.place(plate, placement({0, 0, 1}, 15) * placement({20, 0, 0}), kCasts);
    view.place(plate, placement({0, 0, 2}, 15) * placement({20.025, 0, 0}), kCasts);
    expect_only(count(view), {EDSMCause::OtherEdge});
}

TEST_F(EDSMCausesTest, ASteepFaceIsTestedWrongly) {
    SceneView view = ground_view();
    // A box in the ground: the sun grazes its sides, whose depth changes by more than what they shade within a texel.
    view.place(view.add("box", make_box({3, 3, 2})), placement({0.4, 0.3, 0}, 20), kCasts);
    const EDSMCauses causes = count(view);
    EXPECT_GT(causes.count(EDSMCause::DepthTest), causes.wrong / 4) << tell(causes);
    EXPECT_EQ(causes.count(EDSMCause::OtherEdge), 0u) << tell(causes);
}

}  // namespace
}  // namespace shadow_layers::testing
