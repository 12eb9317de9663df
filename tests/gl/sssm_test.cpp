// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Silhouette maps: the cut of a cell against straight borders, and the technique against exact rays.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/glsl_lib_runner.h"
#include "support/ray_comparison.h"

namespace shadow_layers::testing {
namespace {

/// Middle of the part of the line n . p = c in the unit square at `low`; the square's middle if it misses it.
glm::vec2 cell_point(glm::dvec2 n, double c, glm::dvec2 low) {
    const glm::dvec2 along(-n.y, n.x), foot = n * c;
    double from = -1e9, to = 1e9;
    for (int axis = 0; axis < 2; ++axis) {
        if (std::abs(along[axis]) < 1e-12) continue;
        const double a = (low[axis] - foot[axis]) / along[axis], b = (low[axis] + 1 - foot[axis]) / along[axis];
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    const glm::dvec2 middle = foot + 0.5 * (from + to) * along - low;
    const bool inside = from < to && middle.x >= 0 && middle.x <= 1 && middle.y >= 0 && middle.y <= 1;
    return inside ? glm::vec2(middle) : glm::vec2(0.5f);
}

TEST(SilhouetteMapLib, StraightBordersAreExact) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<glm::vec4> items;
    std::vector<int> lit_corners, lit_here;
    while (lit_here.size() < 20000) {
        const double angle = 3.14159265 * unit(random);
        const glm::dvec2 n(std::cos(angle), std::sin(angle)), at(0.5 + 0.5 * unit(random), 0.5 + 0.5 * unit(random));
        const double c = glm::dot(n, glm::dvec2(0.5)) + 0.7 * unit(random);
        int corners = 0;
        for (int k = 0; k < 4; ++k) corners |= (glm::dot(n, glm::dvec2(k & 1, k >> 1)) > c) << k;
        if (corners == 0 || corners == 15 || std::abs(glm::dot(n, at) - c) < 1e-4) continue;
        const glm::dvec2 cells[5] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
        items.push_back(glm::vec4(at, 0, 0));
        for (const glm::dvec2& cell : cells) items.push_back(glm::vec4(cell_point(n, c, cell) + glm::vec2(cell), 0, 0));
        lit_corners.push_back(corners);
        lit_here.push_back(glm::dot(n, at) > c);
    }
    GlslLibRunner runner;
    const auto out = runner.run("techniques/sssm/silhouette_map_lib.glsl",
                                "outputs[i] = vec4(find_quadrant(inputs[6*i].xy, inputs[6*i+1].xy, inputs[6*i+2].xy,\n"
                                "    inputs[6*i+3].xy, inputs[6*i+4].xy, inputs[6*i+5].xy));",
                                items, int(lit_here.size()), 1);
    for (std::size_t i = 0; i < lit_here.size(); ++i)
        ASSERT_EQ((lit_corners[i] >> int(out[i].x)) & 1, lit_here[i]) << i;
}

TEST(SilhouetteMapLib, SegmentsAreCutToTheirCell) {
    const std::vector<glm::vec4> items = {
        {-1, 0.5f, 3, 0.5f}, {0.25f, 0.25f, 0.25f, 9}, {2, 0, 3, 5}, {0.2f, 0.2f, 0.7f, 0.9f}};
    GlslLibRunner runner;
    const auto out =
        runner.run("techniques/sssm/silhouette_map_lib.glsl",
                   "outputs[i] = vec4(cut_to_cell(inputs[i].xy, inputs[i].zw, vec2(0)), 0, 0);", items, 4, 1);
    EXPECT_NEAR(out[0].x, 0.25, 1e-6);
    EXPECT_NEAR(out[0].y, 0.5, 1e-6);
    EXPECT_EQ(out[1].x, 0);
    EXPECT_NEAR(out[1].y, 0.75 / 8.75, 1e-6);
    EXPECT_GT(out[2].x, out[2].y) << "misses the cell";
    EXPECT_EQ(out[3].x, 0);
    EXPECT_EQ(out[3].y, 1);
}

class SSSMTest : public ::testing::Test {
protected:
    ShadowErrors errors_of(const SceneView& view, const std::string& technique, std::int64_t map_size) {
        return find_shadow_errors(runner_, view, technique, parameters({{"map_size", map_size}}));
    }
    TechniqueRunner runner_;
};

TEST_F(SSSMTest, BeatsTheShadowMapUnderEveryLight) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        SceneView view = box_scene(640, 360);
        view.scene->lights = {make_light(kind, {1.2, 2.6, 4.6}, {0, 0, 0.4})};
        const ShadowErrors sm = errors_of(view, "sm", 256), sssm = errors_of(view, "sssm", 256);
        ASSERT_GT(sm.wrong_ppm, 300);
        EXPECT_LT(sssm.wrong_ppm, 0.1 * sm.wrong_ppm) << int(kind);
        EXPECT_LE(sssm.acne_ppm, 100);
        EXPECT_LE(sssm.leak_ppm, 100);
    }
}

TEST_F(SSSMTest, BeatsTheShadowMapOnRandomScenes) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        SceneView view = random_scene(seed, 480, 270);
        view.scene->lights = {make_light(LightKind::Spot, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 70)};
        const ShadowErrors sm = errors_of(view, "sm", 512), sssm = errors_of(view, "sssm", 512);
        EXPECT_LT(sssm.wrong_ppm, 0.35 * sm.wrong_ppm) << seed;
    }
}

}  // namespace
}  // namespace shadow_layers::testing
