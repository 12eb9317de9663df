// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The stages that techniques share: projection and gradients against double precision, depth maps against planes, edges
// cut to the map, and the cache.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "stages/depth_map.h"
#include "stages/resolve.h"
#include "support/glsl_lib_runner.h"
#include "support/technique_runner.h"
#include "techniques/edsm/edge_distance_map.h"

namespace shadow_layers::testing {
namespace {

// --- shaders/lib/projection_lib.glsl ---

glm::dvec3 project(const glm::dmat4& lc_from_rel, glm::dvec3 p, double size) {
    const glm::dvec4 c = lc_from_rel * glm::dvec4(p, 1);
    return {(c.x / c.w + 1) * 0.5 * size, (c.y / c.w + 1) * 0.5 * size, c.z / c.w};
}

/// Reversed depth as lights/light_views.h says.
glm::dmat4 light_matrix(bool perspective, double near, double far, glm::dvec3 eye, glm::dvec3 target) {
    const glm::dmat4 ls_from_ws = glm::inverse(look_at(eye, target));
    glm::dmat4 lc(0.0);
    if (perspective) {
        lc[0][0] = lc[1][1] = 1.3;
        lc[2][2] = near / (far - near), lc[3][2] = far * near / (far - near), lc[2][3] = -1;
    } else {
        lc[0][0] = lc[1][1] = 0.25;
        lc[2][2] = 1 / (far - near), lc[3][2] = far / (far - near), lc[3][3] = 1;
    }
    return lc * ls_from_ws;
}

TEST(ProjectionLib, PlaceDepthAndGradientMatchDoublePrecision) {
    GlslLibRunner runner;
    std::mt19937 random(31);
    std::uniform_real_distribution<double> unit(-1, 1);
    const double size = 512;
    for (const bool perspective : {true, false}) {
        const glm::dmat4 matrix = light_matrix(perspective, 2, 20, {1, 2, 8}, {0.2, 0.1, 0});
        std::vector<glm::vec4> items;
        std::vector<std::pair<glm::dvec3, glm::dvec3>> receivers;
        for (int k = 0; k < 2000; ++k) {
            const glm::dvec3 p(2 * unit(random), 2 * unit(random), unit(random));
            const glm::dvec3 n = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random) + 1.3));
            const glm::dvec3 to_light =
                perspective ? glm::normalize(glm::dvec3(1, 2, 8) - p) : glm::normalize(glm::dvec3(0.8, 1.9, 8));
            if (glm::dot(n, to_light) < 0.05) continue;
            receivers.emplace_back(glm::vec3(p), glm::vec3(n));
            items.push_back(glm::vec4(p, 0)), items.push_back(glm::vec4(n, 0));
            for (int c = 0; c < 4; ++c) items.push_back(glm::vec4(matrix[c]));
        }
        const auto out = runner.run("lib/projection_lib.glsl",
                                    "mat4 m = mat4(inputs[6*i+2], inputs[6*i+3], inputs[6*i+4], inputs[6*i+5]);\n"
                                    "MapPoint p = project_receiver(m, inputs[6*i].xyz, inputs[6*i+1].xyz, 512.0);\n"
                                    "outputs[2*i] = vec4(p.texel, p.depth_rz, p.rounding);\n"
                                    "outputs[2*i+1] = vec4(p.gradient, reference_depth(p, vec2(0.3, -0.2)), 0.0);",
                                    items, int(receivers.size()), 2);
        for (std::size_t k = 0; k < receivers.size(); ++k) {
            const auto [p, n] = receivers[k];
            const glm::dmat4 rounded = glm::dmat4(glm::mat4(matrix));
            const glm::dvec3 at = project(rounded, p, size);
            // Finite differences along two tangents of the plane; depth is planar in texels, so any step is exact.
            const glm::dvec3 u =
                glm::normalize(glm::cross(n, std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
            const glm::dvec3 v = glm::cross(n, u);
            const glm::dvec3 du = project(rounded, p + 0.01 * u, size) - at,
                             dv = project(rounded, p + 0.01 * v, size) - at;
            const double det = du.x * dv.y - du.y * dv.x;
            const glm::dvec2 gradient((du.z * dv.y - du.y * dv.z) / det, (du.x * dv.z - du.z * dv.x) / det);
            ASSERT_NEAR(out[2 * k].x, at.x, 1e-3);
            ASSERT_NEAR(out[2 * k].y, at.y, 1e-3);
            ASSERT_LE(std::abs(out[2 * k].z - at.z), out[2 * k].w) << "the bound of the rounding holds";
            ASSERT_LT(out[2 * k].w, 1e-4);
            ASSERT_NEAR(out[2 * k + 1].x, gradient.x, 1e-5 + 2e-3 * glm::length(gradient));
            ASSERT_NEAR(out[2 * k + 1].y, gradient.y, 1e-5 + 2e-3 * glm::length(gradient));
            const double slope = 0.3 * out[2 * k + 1].x - 0.2 * out[2 * k + 1].y;
            ASSERT_NEAR(out[2 * k + 1].z, out[2 * k].z + std::max(slope, 0.0) + out[2 * k].w, 1e-6);
        }
    }
}

TEST(ProjectionLib, PointsBesideOrBehindTheLightMakeNoNaN) {
    GlslLibRunner runner;
    const glm::dmat4 matrix = light_matrix(true, 2, 20, {0, 0, 8}, {0, 0, 0});
    std::vector<glm::vec4> items;
    const glm::vec4 places[] = {{0, 0, 8, 0}, {0, 0, 30, 0}, {5, 0, 8, 0}, {0, 0, 0, 0}};
    for (const glm::vec4& place : places) {
        items.push_back(place), items.push_back(glm::vec4(0, 0, place.x > 0 ? 1 : 0, 0));
        for (int c = 0; c < 4; ++c) items.push_back(glm::vec4(matrix[c]));
    }
    const auto out = runner.run("lib/projection_lib.glsl",
                                "mat4 m = mat4(inputs[6*i+2], inputs[6*i+3], inputs[6*i+4], inputs[6*i+5]);\n"
                                "MapPoint p = project_receiver(m, inputs[6*i].xyz, inputs[6*i+1].xyz, 512.0);\n"
                                "outputs[2*i] = vec4(p.texel, p.depth_rz, p.rounding);\n"
                                "outputs[2*i+1] = vec4(p.gradient, reference_depth(p, vec2(0.5)), 0.0);",
                                items, 4, 2);
    for (const glm::vec4& value : out)
        for (int c = 0; c < 4; ++c) EXPECT_TRUE(std::isfinite(value[c]));
}

// --- edges cut to the map ---

LightView spot_view() {
    LightView view;
    view.perspective = true;
    view.size_texels = 100;
    view.near_ls = 1, view.far_ls = 10;
    view.lc_from_ws = light_matrix(true, 1, 10, {0, 0, 0}, {0, 0, -1});
    return view;
}

TEST(LightParameters, MoreViewsThanShadersHaveRoomForAreAnError) {
    Frame frame;
    LightSample sample;
    sample.views.resize(kMaxViews);
    EXPECT_NO_THROW(make_light_params(frame, Light(), sample));
    sample.views.emplace_back();
    EXPECT_THROW(make_light_params(frame, Light(), sample), Error);
}

TEST(MapEdges, InsideEdgesKeepTheirEnds) {
    const LightView view = spot_view();
    const glm::dvec4 a = view.lc_from_ws * glm::dvec4(0.5, 0.2, -3, 1),
                     b = view.lc_from_ws * glm::dvec4(-0.4, 0.9, -5, 1);
    MapEdge edge;
    ASSERT_TRUE(project_edge(view, a, b, 1.5, false, edge));
    EXPECT_FLOAT_EQ(edge.start.x, float((a.x / a.w + 1) * 50));
    EXPECT_FLOAT_EQ(edge.end.y, float((b.y / b.w + 1) * 50));
    EXPECT_FLOAT_EQ(edge.start.z, float(a.z / a.w));
    EXPECT_EQ(edge.start.w, 1);
    ASSERT_TRUE(project_edge(view, a, b, 1.5, true, edge));
    EXPECT_FLOAT_EQ(edge.start.w, 1.0f / 3);
    EXPECT_FLOAT_EQ(edge.end.w, 1.0f / 5);
}

TEST(MapEdges, WhatLiesBehindTheLightIsCutAway) {
    const LightView view = spot_view();
    const glm::dvec4 front = view.lc_from_ws * glm::dvec4(0, 0, -3, 1),
                     behind = view.lc_from_ws * glm::dvec4(0.5, 0, 4, 1);
    MapEdge edge;
    ASSERT_TRUE(project_edge(view, front, behind, 1.5, false, edge));
    for (const glm::vec4& end : {edge.start, edge.end}) {
        EXPECT_TRUE(std::isfinite(end.x) && std::isfinite(end.y));
        EXPECT_GE(end.x, -2);
        EXPECT_LE(end.x, 102);
        EXPECT_GE(end.z, 0);
        EXPECT_LE(end.z, 1);
    }
    EXPECT_FALSE(project_edge(view, behind, behind, 1.5, false, edge));
}

TEST(MapEdges, RandomEdgesAgreeWithDenseSampling) {
    const LightView view = spot_view();
    std::mt19937 random(13);
    std::uniform_real_distribution<double> unit(-1, 1);
    int kept = 0;
    for (int k = 0; k < 3000; ++k) {
        const auto point = [&] {
            return view.lc_from_ws * glm::dvec4(8 * unit(random), 8 * unit(random), 12 * unit(random), 1);
        };
        const glm::dvec4 a = point(), b = point();
        MapEdge edge;
        const bool drawn = project_edge(view, a, b, 1.5, false, edge);
        bool seen = false;
        for (int s = 0; s <= 400; ++s) {
            const glm::dvec4 p = glm::mix(a, b, s / 400.0);
            seen |= p.w > 0.01 && p.z >= 0 && std::abs(p.x) <= p.w && std::abs(p.y) <= p.w;
        }
        if (seen) {
            ASSERT_TRUE(drawn) << k;
        }
        kept += drawn;
    }
    EXPECT_GT(kept, 300);
    EXPECT_LT(kept, 2000);
}

// --- depth map ---

TEST(DepthMapStage, DepthsAreThePlanesPushedByHalfTheirSlope) {
    TechniqueRunner runner;
    SceneView view;
    view.width = 64, view.height = 36;
    view.place(view.add("plane", make_plane(6)), placement({0, 0, 0}, 35, {0, 1, 0}));
    view.camera = make_camera({0, -1, 7}, {0, 0, 0}, 64, 36);
    view.scene->lights = {make_light(LightKind::Spot, {0.5, 0.3, 6}, {0, 0, 0}, 50)};
    const auto run = runner.render(view, "sm", parameters({{"map_size", std::int64_t{64}}}));
    const LightView& light = run.positions[0].views[0];
    for (const double factor : {0.0, 0.5, 2.0}) {
        const auto map = render_depth_map(runner.engine(), *view.scene, run.positions[0], factor);
        const auto depths = map->texture->download<float>();
        const glm::dvec3 normal = glm::dmat3(placement({0, 0, 0}, 35, {0, 1, 0})) * glm::dvec3(0, 0, 1);
        const glm::dmat4 ws_from_lc = glm::inverse(light.lc_from_ws);
        const auto plane_depth = [&](double x, double y) {
            // The ray of the texel's centre, cut with the plane through the origin.
            const auto at = [&](double z) {
                const glm::dvec4 p =
                    ws_from_lc * glm::dvec4(2 * x / light.size_texels - 1, 2 * y / light.size_texels - 1, z, 1);
                return glm::dvec3(p) / p.w;
            };
            const glm::dvec3 near = at(1), far = at(0.0);
            const double t = -glm::dot(near, normal) / glm::dot(far - near, normal);
            const glm::dvec4 hit = light.lc_from_ws * glm::dvec4(near + t * (far - near), 1);
            return hit.z / hit.w;
        };
        for (const int x : {10, 30, 50}) {
            const int y = 33;
            const double centre = plane_depth(x + 0.5, y + 0.5);
            const double slope = std::max(std::abs(plane_depth(x + 1.5, y + 0.5) - centre),
                                          std::abs(plane_depth(x + 0.5, y + 1.5) - centre));
            EXPECT_NEAR(depths[std::size_t(y * light.size_texels + x)], centre - factor * slope,
                        1e-5 + 0.02 * factor * slope)
                << factor;
        }
    }
}

TEST(DepthMapStage, EqualInputsAreWorkedOnce) {
    TechniqueRunner runner;
    SceneView view = box_scene(64, 36);
    view.scene->lights = {make_light(LightKind::Point, {1.2, 2.6, 4.6}, {0, 0, 0})};
    const auto run = runner.render(view, "sm");
    const auto first = render_depth_map(runner.engine(), *view.scene, run.positions[0]);
    EXPECT_EQ(first, render_depth_map(runner.engine(), *view.scene, run.positions[0]));
    EXPECT_NE(first, render_depth_map(runner.engine(), *view.scene, run.positions[0], 2.0));
    EXPECT_EQ(first->texture->layers(), int(run.positions[0].views.size()));
}

TEST(ResolvePass, BandsOfALongPassShadeEachPixelOnce) {
    TechniqueRunner runner;
    SceneView view = box_scene(64, 36);
    view.scene->lights = {make_light(LightKind::Sun, {1.2, 2.6, 4.6}, {0, 0, 0})};
    const auto run = runner.render(view, "sm");
    Engine& engine = runner.engine();
    const auto map = render_depth_map(engine, *view.scene, run.positions[0]);
    const gl::Program& program = engine.program("frame/fullscreen.vert", "techniques/sm/sm.frag");
    ResolvePass pass;
    const auto resolve = [&](double work_per_pixel, GLuint64& shaded) {
        GLuint query = 0;
        engine.gl().GenQueries(1, &query);
        engine.gl().BeginQuery(GL_SAMPLES_PASSED, query);
        const gl::Texture& result = pass.run(engine, {.frame = *run.frame,
                                                      .light = view.scene->lights[0],
                                                      .sample = run.positions[0],
                                                      .program = program,
                                                      .work_per_pixel = work_per_pixel,
                                                      .bind_inputs = [&] { map->texture->bind(kDepthMapUnit); }});
        engine.gl().EndQuery(GL_SAMPLES_PASSED);
        engine.gl().GetQueryObjectui64v(query, GL_QUERY_RESULT, &shaded);
        engine.gl().DeleteQueries(1, &query);
        return result.download<float>();
    };
    GLuint64 at_once = 0, in_rows = 0, in_bands = 0;
    const std::vector<float> whole = resolve(1, at_once);
    EXPECT_EQ(at_once, 64u * 36u);
    EXPECT_EQ(resolve(1e9, in_rows), whole);
    EXPECT_EQ(in_rows, at_once);
    EXPECT_EQ(resolve(1e8 / (64 * 7), in_bands), whole);  // seven rows each, the last band is shorter
    EXPECT_EQ(in_bands, at_once);
    // The last band's limits must not stay: clears would mind them.
    gl::Framebuffer target(engine.device(), "cleared");
    auto cleared = std::make_shared<gl::Texture>(engine.device(), gl::TextureDesc{GL_R32F, 64, 36}, "cleared");
    target.attach_color(0, cleared);
    target.clear_color(0, 7);
    EXPECT_EQ(cleared->download<float>(), std::vector<float>(64 * 36, 7.0f));
}

TEST(EdgeDistanceStage, TexelsHoldTheLineOfTheNearestEdge) {
    TechniqueRunner runner;
    SceneView view;
    view.width = 64, view.height = 36;
    view.place(view.add("ground", make_plane(8)));
    view.place(view.add("half", make_plane(8)), placement({4.0131, 0, 1}, 0), kInstanceShadow);
    view.camera = make_camera({0, 0, 10}, {0, 0, 0}, 64, 36, 12);
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0})};
    const auto run = runner.render(view, "edsm", parameters({{"map_size", std::int64_t{64}}}));
    const auto depth = render_depth_map(runner.engine(), *view.scene, run.positions[0]);
    EdgeDistanceOptions options;
    options.edges.half_width_texels = 1.5;
    const auto map = render_edge_distance_map(runner.engine(), *view.scene, run.positions[0], *depth, options);
    const LightView& light = run.positions[0].views[0];
    const glm::dvec4 edge_lc = light.lc_from_ws * glm::dvec4(0.0131, 0, 1, 1);
    const glm::dvec4 lit_lc = light.lc_from_ws * glm::dvec4(-1, 0, 1, 1);
    const glm::dvec2 edge = (glm::dvec2(edge_lc) + 1.0) * 0.5 * double(light.size_texels);
    const glm::dvec2 towards_lit = glm::normalize(glm::dvec2(lit_lc) - glm::dvec2(edge_lc));
    gl::Framebuffer target(runner.engine().device(), "read");
    target.attach_color(0, map->texture, 0);
    target.bind();
    std::vector<float> texels(std::size_t(4 * light.size_texels * light.size_texels));
    const auto& gl = runner.engine().gl();
    GLint name = 0;
    gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &name);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(name));
    gl.ReadPixels(0, 0, light.size_texels, light.size_texels, GL_RGBA, GL_FLOAT, texels.data());
    int held = 0;
    for (int y = 10; y < light.size_texels - 10; ++y)
        for (int x = 0; x < light.size_texels; ++x) {
            const double signed_distance = glm::dot(glm::dvec2(x + 0.5, y + 0.5) - edge, towards_lit);
            const float* texel = &texels[std::size_t(4 * (y * light.size_texels + x))];
            if (std::abs(signed_distance) > 1.52) {
                ASSERT_EQ(texel[3], kNoEdgeDepth);
            } else if (std::abs(signed_distance) < 1.48) {
                ++held;
                ASSERT_NEAR(texel[0], towards_lit.x, 2e-3);
                ASSERT_NEAR(texel[1], towards_lit.y, 2e-3);
                ASSERT_NEAR(texel[2], signed_distance, 2e-3);
                ASSERT_NEAR(texel[3], edge_lc.z, 1e-3);
            }
        }
    EXPECT_GT(held, 100);
}

}  // namespace
}  // namespace shadow_layers::testing
