// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Extended shadow maps: quads by their geometry, borders against lines known in closed form, pictures against exact
// rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/ray_comparison.h"
#include "techniques/extsm/extended_map.h"
#include "techniques/extsm/extended_quads.h"

namespace shadow_layers::testing {
namespace {

glm::dvec3 random_direction(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

/// An edge along x of a wedge whose facets meet at `angle`, the first one in the xy plane.
struct Wedge {
    glm::dvec3 a{0, 0, 0}, b{1, 0, 0}, c{0.3, -1, 0}, d;
    explicit Wedge(double angle) : d(0.6, -std::cos(angle), -std::sin(angle)) {}
};

/// What the light sees of a unit step along `q` across the edge along x.
double seen_width(glm::dvec3 q, glm::dvec3 light) {
    return std::abs(glm::dot(q, glm::normalize(glm::cross(light, glm::dvec3(1, 0, 0)))));
}

TEST(ExtendedQuads, KeepSeventyPercentOfTheirWidthAtEveryCorner) {
    std::mt19937 random(7);
    double least = 1, least_unsplit = 1;
    int bevelled = 0, square = 0;
    for (int k = 0; k < 40000; ++k) {
        const double angle = 3.1 * double(k % 1000 + 1) / 1000;
        const Wedge wedge(angle);
        const glm::dvec3 light = random_direction(random);
        const glm::dvec3 up(0, 0, 1), other = glm::normalize(glm::cross(wedge.d, glm::dvec3(1, 0, 0)));
        // Outward, away from the solid between the facets.
        const glm::dvec3 outward = glm::dot(other, wedge.c) < 0 ? other : -other;
        if (glm::dot(light, up) <= 0 || glm::dot(light, outward) >= 0) continue;
        // Silhouettes come with their caster on the left as the light sees it.
        const bool turned = glm::dot(glm::cross(wedge.b - wedge.a, wedge.c - wedge.a), light) < 0;
        const EdgeFacets facets = turned ? find_facets(wedge.b, wedge.a, wedge.c, &wedge.d)
                                         : find_facets(wedge.a, wedge.b, wedge.c, &wedge.d);
        ASSERT_NEAR(glm::distance(facets.lit, up), 0, 1e-9);
        ASSERT_NEAR(glm::distance(facets.dark, outward), 0, 1e-9);
        const Extrusion extrusion = find_extrusion(facets, light);
        ASSERT_EQ(extrusion.bevelled, glm::dot(up, outward) < 0);
        (extrusion.bevelled ? bevelled : square) += 1;
        least = std::min(least, seen_width(extrusion.direction, light));
        least_unsplit = std::min(least_unsplit, seen_width(find_extrusion(facets, light, false).direction, light));
    }
    EXPECT_GT(bevelled, 1000);
    EXPECT_GT(square, 1000);
    EXPECT_GE(least, std::sqrt(0.5) - 1e-9) << "[Bujnak04] 4.1";
    EXPECT_LT(least_unsplit, 0.3) << "what the second quad is for";
}

TEST(ExtendedQuads, BoundariesAreFoldedSheets) {
    const Wedge wedge(1);
    const EdgeFacets facets = find_facets(wedge.b, wedge.a, wedge.c, nullptr);
    for (const glm::dvec3 light : {glm::dvec3(0, 0.5, 1), glm::dvec3(0, -0.5, 1), glm::dvec3(0.2, 0, 1)}) {
        const Extrusion extrusion = find_extrusion(facets, light);
        EXPECT_TRUE(extrusion.bevelled);
        EXPECT_GT(extrusion.direction.y, 0.7) << "out of the triangle, which lies at negative y";
        EXPECT_GE(seen_width(extrusion.direction, light), std::sqrt(0.5) - 1e-9);
    }
}

/// A square plate that the camera doesn't see, above a plane, turned by `turn_deg`.
SceneView plate_scene(double turn_deg, LightKind kind) {
    SceneView view;
    view.width = 400, view.height = 400;
    view.place(view.add("plane", make_plane(6)));
    view.place(view.add("plate", make_plane(1.6f)), placement({0, 0, 1}, turn_deg), kInstanceShadow);
    view.camera = make_camera({0, 0.001, 6}, {0, 0, 0}, view.width, view.height, 40);
    view.scene->lights = {make_light(kind, {0.4, -0.3, 5}, {0, 0, 0}, 60)};
    return view;
}

class ExtSMTest : public ::testing::Test {
protected:
    ShadowErrors errors_of(const SceneView& view, const std::string& technique, const ParameterValues& given) {
        return find_shadow_errors(runner_, view, technique, given);
    }

    struct BorderSpan {
        double farthest_dark = -1e9, nearest_lit = 1e9;  ///< in texels outside of the plate's outline
    };
    /// Of the plate's first side, away from its corners.
    BorderSpan find_border(const SceneView& view, const ParameterValues& given) {
        const auto run = runner_.render(view, "extsm", given);
        const LightSample& position = run.positions[0];
        const glm::dmat4& matrix = view.scene->instances[1].world_from_object;
        BorderSpan span;
        for (std::size_t pixel = 0; pixel < run.visibility().size(); ++pixel) {
            const glm::dvec3 place = run.frame->origin_ws + glm::dvec3(run.frame->positions_rel[pixel]);
            const LightView& map = position.views[0];
            const auto to_texels = [&](glm::dvec3 point) {
                const glm::dvec4 lc = map.lc_from_ws * glm::dvec4(point, 1);
                return (glm::dvec2(lc) / lc.w + 1.0) * (0.5 * map.size_texels);
            };
            const glm::dvec2 a = to_texels(matrix * glm::dvec4(-0.8, -0.8, 0, 1)),
                             b = to_texels(matrix * glm::dvec4(0.8, -0.8, 0, 1)), at = to_texels(place) - a;
            const glm::dvec2 along = glm::normalize(b - a);
            const double run_texels = glm::dot(at, along);
            if (run_texels < 5 || run_texels > glm::distance(a, b) - 5) continue;
            glm::dvec2 outward(along.y, -along.x);
            if (glm::dot(outward, to_texels(matrix * glm::dvec4(0, 0, 0, 1)) - a) > 0) outward = -outward;
            const double outside = glm::dot(at, outward);
            if (std::abs(outside) > 4) continue;
            if (run.visibility()[pixel] < 0.5f)
                span.farthest_dark = std::max(span.farthest_dark, outside);
            else
                span.nearest_lit = std::min(span.nearest_lit, outside);
        }
        return span;
    }
    TechniqueRunner runner_;
};

ParameterValues values_of(std::int64_t map_size, const std::string& reading, const std::string& overlap = "max") {
    return parameters({{"map_size", map_size}, {"reading", reading}, {"overlap", overlap}});
}

TEST_F(ExtSMTest, StraightBordersAreAsFineAsTheirBytes) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot})
        for (const double turn_deg : {13.0, 30.0, 45.0}) {
            const SceneView view = plate_scene(turn_deg, kind);
            const BorderSpan forced = find_border(view, values_of(64, "forced"));
            const double kRounding = 1.0 / 64, kForcedStep = kTexelDiagonal / 255, kStep = kQuadWidthTexels / 255;
            EXPECT_LT(forced.farthest_dark, kForcedStep + kRounding) << turn_deg;
            EXPECT_GT(forced.nearest_lit, -kForcedStep - kRounding) << turn_deg;
            // Between 0.7 of the shift and all of it, by how much the quad is foreshortened.
            const BorderSpan paper = find_border(view, values_of(64, "paper"));
            EXPECT_LT(paper.farthest_dark, kShiftTexels + kStep + kRounding) << turn_deg;
            EXPECT_GT(paper.nearest_lit, std::sqrt(0.5) * kShiftTexels - kStep - kRounding) << turn_deg;
        }
}

TEST_F(ExtSMTest, ForcedBeatsTheShadowMapUnderEveryLight) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        SceneView box = box_scene(480, 270), random = random_scene(2, 480, 270);
        for (SceneView* view : {&box, &random}) {
            view->scene->lights = {make_light(kind, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 70)};
            const ShadowErrors sm = errors_of(*view, "sm", parameters({{"map_size", std::int64_t(256)}}));
            const ShadowErrors forced = errors_of(*view, "extsm", values_of(256, "forced"));
            ASSERT_GT(sm.wrong_ppm, 300);
            EXPECT_LT(forced.wrong_ppm, (view == &box ? 0.1 : 0.3) * sm.wrong_ppm) << int(kind);
        }
    }
}

TEST_F(ExtSMTest, OverlapRulesPartWhereEdgesCross) {
    SceneView view = random_scene(2, 480, 270);
    view.scene->lights = {make_light(LightKind::Spot, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 70)};
    const ShadowErrors farthest = errors_of(view, "extsm", values_of(512, "paper", "max"));
    const ShadowErrors nearest = errors_of(view, "extsm", values_of(512, "paper", "min"));
    EXPECT_GT(nearest.wrong_ppm, 1.05 * farthest.wrong_ppm) << "[Bujnak04] figure 9: wider shadows";
    SceneView lone = box_scene(480, 270);
    lone.scene->lights = view.scene->lights;
    const auto max = runner_.render(lone, "extsm", values_of(512, "paper", "max"));
    const auto min = runner_.render(lone, "extsm", values_of(512, "paper", "min"));
    std::size_t differing = 0;
    for (std::size_t i = 0; i < max.visibility().size(); ++i) differing += max.visibility()[i] != min.visibility()[i];
    EXPECT_LE(differing, 20u) << "a lone caster's edges meet in corners only";
}

TEST_F(ExtSMTest, AttenuationIsAChannelOfItsOwn) {
    SceneView view = box_scene(160, 90);
    view.scene->lights = {make_light(LightKind::Point, {1.2, 2.6, 4.6}, {0, 0, 0.4})};
    const glm::dvec3 light(1.2, 2.6, 4.6);
    for (const char* mode : {"none", "linear", "quadratic"}) {
        const auto run = runner_.render(
            view, "extsm",
            parameters({{"map_size", std::int64_t(128)}, {"attenuation", std::string(mode)}, {"range", 8.0}}));
        const std::vector<float>& intensity = run.channels.at("intensity").data;
        for (std::size_t i = 0; i < intensity.size(); ++i) {
            double factor = 1;
            if (run.frame->ids[i].instance != kNoId && std::string(mode) != "none") {
                const double x =
                    glm::distance(run.frame->origin_ws + glm::dvec3(run.frame->positions_rel[i]), light) / 8;
                factor = std::max(0.0, std::string(mode) == "linear" ? 1 - x : 1 - x * x);
            }
            ASSERT_NEAR(intensity[i], run.visibility()[i] * factor, 1e-4) << mode;
        }
    }
}

}  // namespace
}  // namespace shadow_layers::testing
