// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Depths of edges in half floats (techniques/edsm/edge_depth_lib.glsl), down to near planes at a millionth of the far
// one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "support/glsl_lib_runner.h"
#include "support/ray_comparison.h"
#include "techniques/edsm/edge_distance_map.h"

namespace shadow_layers::testing {
namespace {

/// A ground of 3 x 3 under a lamp at (0, 0, 2). The caster is one mesh: a plate just above the ground, and a cap behind
/// the lamp, so that the mesh's box holds the lamp and the near plane is as near as one ever is.
SceneView lantern_scene(float plate_height, bool with_cap) {
    SceneView view;
    view.width = 480, view.height = 270;
    view.place(view.add("ground", make_plane(3)));
    MeshData caster = make_plane(1);
    for (glm::vec3& p : caster.positions) p.z = plate_height;
    if (with_cap) {
        const MeshData cap = make_plane(1);
        for (const glm::vec3& p : cap.positions) caster.positions.push_back({p.x, p.y, 3});
        for (const glm::uvec3& t : cap.triangles) caster.triangles.push_back(t + glm::uvec3(4));
    }
    view.place(view.add("lantern", caster), placement({0.08, 0.05, 0}, 21), kInstanceShadow);
    view.camera = make_camera({0, -0.3, 4}, {0, 0, 0}, view.width, view.height, 32);
    view.scene->lights = {make_light(LightKind::Point, {0, 0, 2}, {0, 0, 0})};
    return view;
}

TEST(EDSMDepth, ACasterRoundTheLightKeepsItsEdges) {
    TechniqueRunner runner;
    const ParameterValues values = parameters({{"map_size", std::int64_t{128}}});
    for (const float height : {0.02f, 0.1f, 0.5f}) {
        SCOPED_TRACE(height);
        const SceneView view = lantern_scene(height, true);
        const LightView map = runner.render(view, "edsm", values).positions.at(0).views.at(0);
        ASSERT_LT(map.near_ls, 2e-6 * map.far_ls) << "the scene tests nothing";
        const ShadowErrors sm = find_shadow_errors(runner, view, "sm", values);
        const ShadowErrors edsm = find_shadow_errors(runner, view, "edsm", values);
        ASSERT_GT(sm.wrong_ppm, 1000);
        EXPECT_LE(edsm.wrong_ppm, 0.03 * sm.wrong_ppm) << "sm " << sm.wrong_ppm;
        // The near plane is nothing to a shadow.
        EXPECT_NEAR(edsm.wrong_ppm, find_shadow_errors(runner, lantern_scene(height, false), "edsm", values).wrong_ppm,
                    50);
    }
}

std::vector<LightView> make_views() {
    TechniqueRunner runner;
    std::vector<LightView> views;
    std::vector<SceneView> scenes{box_scene(96, 54), lantern_scene(0.5f, true)};
    for (SceneView& view : scenes)
        for (const LightKind kind : kAllLightKinds)
            for (const double distance : {1.0, 4.0, 1000.0}) {
                view.scene->lights = {make_light(kind, glm::dvec3(0.3, 0.5, 1.0) * distance, {0, 0, 0.2})};
                const TechniqueRun run = runner.render(view, "edsm");
                views.insert(views.end(), run.positions.at(0).views.begin(), run.positions.at(0).views.end());
            }
    return views;
}

TEST(EDSMDepth, TheShaderFindsTheScaleInTheMatrix) {
    const std::vector<LightView> views = make_views();
    std::vector<glm::vec4> items;
    for (const LightView& view : views) {
        const glm::mat4 lc_from_rel(glm::translate(view.lc_from_ws, glm::dvec3(7, -3, 2)));
        for (int column = 0; column < 4; ++column) items.push_back(lc_from_rel[column]);
    }
    GlslLibRunner runner;
    const auto out = runner.run("techniques/edsm/edge_depth_lib.glsl",
                                "outputs[i] = vec4(edge_depth_scale(mat4(inputs[4*i], inputs[4*i+1], inputs[4*i+2],\n"
                                "                                        inputs[4*i+3])));",
                                items, int(views.size()), 1);
    int stretched = 0, parallel = 0;
    for (std::size_t k = 0; k < views.size(); ++k) {
        const LightView& view = views[k];
        const double wanted = view.perspective ? std::max((view.far_ls - view.near_ls) / view.near_ls, 1.0) : 1.0;
        stretched += wanted > 1, parallel += !view.perspective;
        EXPECT_NEAR(out[k].x, wanted, 1e-4 * wanted);
        EXPECT_NEAR(compute_edge_depth_scale(view), wanted, 1e-9 * wanted);
    }
    EXPECT_GT(stretched, 10);
    EXPECT_GT(parallel, 3);
}

class EDSMHalfDepth : public ::testing::Test {
protected:
    /// What the map gives back of points `w` from the light, in units of the far plane's distance.
    std::vector<float> store(double near, const std::vector<double>& distances) {
        std::vector<glm::vec4> items;
        for (const double w : distances)
            items.push_back({float(near * (1 - w) / ((1 - near) * w)), float(std::max(1 / near - 1, 1.0)), 0, 0});
        const auto out = runner_.run("techniques/edsm/edge_depth_lib.glsl",
                                     "float depth = encode_edge_depth(inputs[i].x, inputs[i].y);\n"
                                     "outputs[i] = vec4(unpackHalf2x16(packHalf2x16(vec2(depth))).x);",
                                     items, int(items.size()), 1);
        std::vector<float> stored;
        for (const glm::vec4& value : out) stored.push_back(value.x);
        return stored;
    }
    GlslLibRunner runner_;
};

TEST_F(EDSMHalfDepth, TheOrderOfDepthsIsKept) {
    for (const double near : {0.9, 0.5, 0.1, 1e-3, 1e-6}) {
        SCOPED_TRACE(near);
        std::vector<double> distances;
        const double least = std::max(near, 1.001 / double(kGreatestEdgeDepth));
        for (int k = 0; k <= 400; ++k) distances.push_back(0.999 * std::pow(least / 0.999, k / 400.0));
        const std::vector<float> stored = store(near, distances);
        for (std::size_t k = 1; k < stored.size(); ++k) {
            if (distances[k] > 0.995 * distances[k - 1]) continue;  // half floats have eleven bits
            EXPECT_LT(stored[k - 1], stored[k]) << distances[k];
        }
    }
}

TEST_F(EDSMHalfDepth, TheNearestDepthsAreEqual) {
    for (const float stored : store(1e-6, {1e-6, 3e-6, 1e-5, 1.6e-5})) EXPECT_EQ(stored, kGreatestEdgeDepth);
}

}  // namespace
}  // namespace shadow_layers::testing
