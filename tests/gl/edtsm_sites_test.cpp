// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What edtsm is built of: sites, footprints, parts of a light; and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lights/facing.h"
#include "shadow_layers/error.h"
#include "support/glsl_lib_runner.h"
#include "support/technique_runner.h"
#include "techniques/edtsm/border_sites.h"

namespace shadow_layers::testing {
namespace {

/// A box over a plane, before a wall: one border on the plane, and depth edges and faces turned away that are none.
SceneView make_room() {
    SceneView view = box_scene(320, 180);
    view.place(view.add("wall", make_plane(6)), placement({0, 2.5, 1}, 90, {1, 0, 0}));
    view.scene->lights = {make_light(LightKind::Point, {1.2, -1.6, 4.6}, {0, 0, 0.4})};
    return view;
}

// A site lies on the same flat face as a neighbour that the map answers differently. The faces here are flat, so that
// the triangles' planes tell it without any threshold.
TEST(BorderSites, AreThoseOfBruteForce) {
    const SceneView view = make_room();
    TechniqueRunner runner;
    const auto run = runner.render(view, "edsm", parameters({{"map_size", std::int64_t{512}}}));
    const Frame& frame = *run.frame;

    gl::Texture hard_tx(runner.engine().device(), {GL_R32F, frame.width, frame.height}, "hard");
    hard_tx.upload(run.visibility().data());
    const PenumbraSettings settings{.from_light = false, .width = 0.1};
    const ParameterValues values;
    FrameMaker maker(runner.engine(), std::make_shared<FramePool>(),
                     {view.scene, view.camera, view.width, view.height, {0, 0, view.width, view.height}, 0});
    const auto fresh = maker.make(glm::dvec2(0));
    SampleFrames frames(maker, glm::dvec2(0));
    PenumbraBlocks blocks;
    blocks.bind(runner.engine(), {*fresh, frames, view.scene->lights[0], run.positions[0], values}, settings);
    BorderSites finder;
    const auto sites = finder.find(runner.engine(), *fresh, settings, hard_tx, nullptr);
    const auto mask = sites.mask_tx.download<std::uint8_t>();

    const FacingRule facing(*fresh, view.scene->lights[0], run.positions[0]);
    const auto is_one_face = [&](std::size_t a, std::size_t b) {
        return fresh->ids[a].instance == fresh->ids[b].instance &&
               glm::length(fresh->normals[a] - fresh->normals[b]) < 1e-4f;
    };
    int expected = 0, wrong = 0, depth_edges = 0;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            const std::size_t pixel = std::size_t(y * frame.width + x);
            bool is_site = false;
            for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
                if (x + dx < 0 || x + dx >= frame.width || y + dy < 0 || y + dy >= frame.height) continue;
                const std::size_t other = std::size_t((y + dy) * frame.width + x + dx);
                if ((run.visibility()[pixel] >= 0.5f) == (run.visibility()[other] >= 0.5f)) continue;
                if (facing.classify(pixel) != Facing::Undecided || facing.classify(other) != Facing::Undecided)
                    continue;
                is_site = is_site || is_one_face(pixel, other);
                depth_edges += fresh->ids[pixel].instance != fresh->ids[other].instance;
            }
            expected += is_site;
            wrong += is_site != (mask[pixel] != 0);
        }
    EXPECT_GT(expected, 300);
    EXPECT_GT(depth_edges, 20) << "the scene must hold what could be mistaken";
    EXPECT_LE(wrong, 4) << "of " << expected << ": where wall and plane meet, a border may pass from one to the other";
    EXPECT_EQ(sites.site_count, std::count(mask.begin(), mask.end(), std::uint8_t(1)));
}

TEST(LightCut, IsThatOfManyPoints) {
    GlslLibRunner runner;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::vector<glm::vec4> inputs;
    constexpr int kCount = 400;
    for (int k = 0; k < kCount; ++k) {
        glm::vec4 plane(unit(random), unit(random), 0.8f * unit(random), float(k % 2));
        if (k % 7 == 0) plane.x = 0;   // along a side
        if (k % 11 == 0) plane.z = 0;  // through the middle
        inputs.push_back(plane);
    }
    const auto outputs = runner.run(
        "techniques/edtsm/light_cut_lib.glsl",
        "vec4 a = inputs[i];\n"
        "outputs[i] = vec4(fraction_beside_plane(int(a.w), vec3(a.xy, 1.0), vec3(0.0, 0.0, a.z), vec3(1.0, 0.0, 0.0),"
        " vec3(0.0, 1.0, 0.0)));",
        inputs, kCount, 1);
    constexpr int kSide = 200;
    for (int k = 0; k < kCount; ++k) {
        const glm::vec4& a = inputs[std::size_t(k)];
        double beside = 0, all = 0;
        for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i) {
                const double x = 2 * (i + 0.5) / kSide - 1, y = 2 * (j + 0.5) / kSide - 1;
                if (a.w == 0 && x * x + y * y > 1) continue;
                all += 1;
                beside += a.x * x + a.y * y + std::abs(a.z) > 0;
            }
        EXPECT_NEAR(outputs[std::size_t(k)].x, beside / all, 0.012) << a.x << " " << a.y << " " << a.z << " " << a.w;
    }
}

TEST(PixelFootprint, IsTheWayToTheNextRayOnThePlane) {
    GlslLibRunner runner;
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.5, 0.8)), forward(0, 0.6, -0.8), right(1, 0, 0);
    const glm::dvec3 up = glm::cross(right, forward);
    constexpr double kPixel = 0.003, kDistance = -7.0;  // of the plane: dot(normal, p) = kDistance
    for (const bool perspective : {true, false}) {
        const auto meet = [&](double x, double y) {
            const glm::dvec3 across = kPixel * (x * right + y * up);
            const glm::dvec3 origin = perspective ? glm::dvec3(0) : across;
            const glm::dvec3 direction = perspective ? forward + across : forward;
            return origin + direction * ((kDistance - glm::dot(normal, origin)) / glm::dot(normal, direction));
        };
        const glm::dvec3 here = meet(20, -12);
        const std::string camera = perspective
                                       ? "vec4(0.0, 0.6, -0.8, 1.0), vec4(0.0), vec4(0.0), inputs[2], inputs[3]"
                                       : "vec4(0.0, 0.6, -0.8, 0.0), inputs[2], inputs[3], vec4(0.0), vec4(0.0)";
        const auto out = runner.run("techniques/edtsm/pixel_footprint_lib.glsl",
                                    "Footprint f = compute_footprint(PixelCamera(" + camera +
                                        "), inputs[0].xyz, inputs[1].xyz);\n"
                                        "outputs[0] = vec4(f.dx, f.depth_vs); outputs[1] = vec4(f.dy, f.side);"
                                        "outputs[2] = vec4(f.depth_step, 0.0, 0.0);",
                                    {glm::vec4(glm::vec3(here), 0), glm::vec4(glm::vec3(normal), 0),
                                     glm::vec4(glm::vec3(kPixel * right), 0), glm::vec4(glm::vec3(kPixel * up), 0)},
                                    1, 3);
        const double depth = glm::dot(here, forward), step = 1e-3;
        const glm::dvec3 dx = (meet(20 + step, -12) - here) / step, dy = (meet(20, -12 + step) - here) / step;
        EXPECT_LT(glm::length(glm::dvec3(out[0]) - dx), 1e-3 * glm::length(dx));
        EXPECT_LT(glm::length(glm::dvec3(out[1]) - dy), 1e-3 * glm::length(dy));
        EXPECT_NEAR(out[0].w, depth, 1e-4);
        EXPECT_NEAR(out[1].w, kPixel * (perspective ? depth : 1), 1e-5);
        EXPECT_NEAR(out[2].x, glm::dot(dx, forward), 1e-3 * glm::length(dx));
        EXPECT_NEAR(out[2].y, glm::dot(dy, forward), 1e-3 * glm::length(dy));
    }
}

std::string refusal_of(TechniqueRunner& runner, const SceneView& view, const ParameterValues& values) {
    try {
        runner.render(view, "edtsm", values);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was refused";
}

TEST(EDTSMParameters, AreRefusedByNameValueAndRange) {
    TechniqueRunner runner;
    const SceneView view = make_room();
    const auto contains = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos;
    };
    for (const double width : {0.0, -1.0}) {
        const std::string text = refusal_of(runner, view, parameters({{"penumbra", width}}));
        EXPECT_TRUE(contains(text, "\"penumbra\"") && contains(text, "from 1e-06 to 1e+06")) << text;
    }
    EXPECT_EQ(refusal_of(runner, view, parameters({{"penumbra", 40.0}})), "nothing was refused");
}

TEST(EDTSM, ALightWithoutSizeCastsTheSourcesShadow) {
    TechniqueRunner runner;
    const SceneView view = make_room();
    const auto source = runner.render(view, "edsm", parameters({{"map_size", std::int64_t{512}}}));
    const auto run = runner.render(
        view, "edtsm",
        parameters({{"map_size", std::int64_t{512}}, {"source", std::string("edsm")}, {"overscan", std::int64_t{0}}}));
    int different = 0;  // views have another border of texels
    for (std::size_t pixel = 0; pixel < source.visibility().size(); ++pixel)
        different += source.visibility()[pixel] != run.visibility()[pixel];
    EXPECT_LE(different, 30);
}

TEST(EDTSM, ARegionIsThatPartOfThePicture) {
    TechniqueRunner runner;
    SceneView view = random_scene(2, 320, 180);
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        view.scene->lights = {make_light(kind, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 60)};
        const ParameterValues values = parameters({{"map_size", std::int64_t{512}},
                                                   {"source", std::string("edsm")},
                                                   {"penumbra_from", std::string("fixed")},
                                                   {"penumbra", 0.3}});
        const auto whole = runner.render(view, "edtsm", values);
        const PixelRect region{60, 40, 170, 90};
        const auto part = runner.render(view, "edtsm", values, 0, region);
        const int rim = part.frame->overscan_px;
        double difference = 0;
        for (int y = 0; y < region.height; ++y)
            for (int x = 0; x < region.width; ++x)
                difference += std::abs(
                    part.visibility()[std::size_t((y + rim) * part.frame->width + x + rim)] -
                    whole.visibility()[std::size_t((y + region.y + rim) * whole.frame->width + x + region.x + rim)]);
        EXPECT_LT(difference / (region.width * region.height), 0.001) << int(kind);
    }
}

}  // namespace
}  // namespace shadow_layers::testing
