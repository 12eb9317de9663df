// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// pcf against what it must equal: sm for one tap, a brute-force mean of sm-like tests, and a ramp of known width.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

class PCFTest : public ::testing::Test {
protected:
    TechniqueRunner runner_;
};

TEST_F(PCFTest, OneTapEqualsTheStandardShadowMapExactly) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        SceneView view = random_scene(4, 200, 112);
        view.scene->lights = {make_light(kind, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 70)};
        const ParameterValues map = parameters({{"map_size", std::int64_t{256}}});
        ParameterValues one = map;
        one.set("kernel", std::int64_t{1});
        one.set("radius", 7.0);  // of no effect with one tap
        EXPECT_EQ(runner_.render(view, "sm", map).visibility(), runner_.render(view, "pcf", one).visibility());
    }
}

TEST_F(PCFTest, TheEarlyOutChangesNoBit) {
    const std::vector<ParameterValues> settings = {
        parameters({{"kernel", std::int64_t{1}}}),
        parameters({{"kernel", std::int64_t{2}}}),
        parameters({{"kernel", std::int64_t{3}}, {"bilinear", true}}),
        parameters({{"kernel", std::int64_t{7}}}),
        parameters({{"kernel", std::int64_t{6}}, {"radius", 6.3}, {"bilinear", true}}),
        parameters({{"kernel", std::int64_t{10}}}),
    };
    unsigned seed = 20;
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area})
        for (ParameterValues given : settings) {
            SceneView view = random_scene(++seed, 160, 90);
            view.scene->lights = {make_light(kind, {1.2 - 0.1 * seed, 2.6, 4.6}, {0, 0, 0.4}, 70)};
            given.set("map_size", std::int64_t{seed % 2 ? 301 : 96});
            const auto early = runner_.render(view, "pcf", given).visibility();
            given.set("early_out", false);
            EXPECT_EQ(early, runner_.render(view, "pcf", given).visibility()) << seed;
        }
}

/// A half-plane caster over a ground plane under a sun from above: visibility depends on x alone.
SceneView half_plane_scene() {
    SceneView view;
    view.width = 256, view.height = 16;
    view.place(view.add("ground", make_plane(8)));
    view.place(view.add("half", make_plane(8)), placement({4.0131, 0, 1}), kInstanceShadow);
    view.camera = make_camera({0, 0, 10}, {0, 0, 0}, 256, 16, 12);
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0})};
    return view;
}

TEST_F(PCFTest, TheRampHasTheKernelsWidth) {
    const SceneView view = half_plane_scene();
    for (const int kernel : {3, 4, 5, 9, 10}) {
        const auto run = runner_.render(
            view, "pcf",
            parameters({{"map_size", std::int64_t{256}}, {"kernel", std::int64_t{kernel}}, {"bilinear", true}}));
        const double texel =
            2.0 / std::abs(run.positions[0].views[0].lc_from_ws[0][0]) / run.positions[0].views[0].size_texels;
        const auto& values = run.visibility();
        const auto& places = run.frame->positions_rel;
        double total = 0, first = 1e9, last = -1e9;
        for (int x = 0; x < view.width; ++x) {
            const std::size_t pixel = std::size_t(8 * view.width + x);
            const float v = values[pixel];
            total += v;
            if (v > 0 && v < 1) {
                first = std::min(first, double(places[pixel].x));
                last = std::max(last, double(places[pixel].x));
            }
        }
        const double pixel_size = places[1].x - places[0].x;
        EXPECT_NEAR(last - first, kernel * texel, 2 * pixel_size + 0.2 * texel) << kernel;
        // The border stays where it is: lit length as without a filter, to a texel.
        const double lit_to = 0.0131;
        const double lit_from = places[std::size_t(8 * view.width)].x - pixel_size / 2;
        EXPECT_NEAR(total * pixel_size, lit_to - lit_from, texel) << kernel;
    }
}

TEST_F(PCFTest, RadiusSpreadsTheTaps) {
    const SceneView view = half_plane_scene();
    const auto width_of = [&](double radius) {
        const auto run = runner_.render(
            view, "pcf",
            parameters({{"map_size", std::int64_t{256}}, {"kernel", std::int64_t{5}}, {"radius", radius}}));
        return std::count_if(run.visibility().begin(), run.visibility().end(), [](float v) { return v > 0 && v < 1; });
    };
    const auto plain = width_of(0), same = width_of(2), wide = width_of(8);
    EXPECT_EQ(plain, same);  // five taps one texel apart reach two texels
    EXPECT_NEAR(double(wide) / double(plain), 16.0 / 4.0, 0.8);
}

TEST_F(PCFTest, NoSeamsAtCubeFacesAndMapRims) {
    // Point light in the middle of an empty room: nothing is in shadow, whatever the kernel reaches over.
    SceneView view;
    view.width = 220, view.height = 124;
    const auto wall = view.add("wall", make_plane(4, 3));
    view.place(wall, placement({0, 0, -2}));
    view.place(wall, placement({0, 0, 2}, 180, {1, 0, 0}));
    view.place(wall, placement({-2, 0, 0}, 90, {0, 1, 0}));
    view.place(wall, placement({2, 0, 0}, -90, {0, 1, 0}));
    view.place(wall, placement({0, 2, 0}, 90, {1, 0, 0}));
    view.place(wall, placement({0, -2, 0}, -90, {1, 0, 0}));
    view.camera = make_camera({-1.7, -1.6, 1.2}, {1, 1.2, -0.4}, view.width, view.height, 100);
    view.scene->lights = {make_light(LightKind::Point, {0.11, 0.07, 0.13}, {1, 0.4, 0.2})};
    for (const int kernel : {3, 9, 21}) {
        const auto run = runner_.render(
            view, "pcf",
            parameters({{"map_size", std::int64_t{64}}, {"kernel", std::int64_t{kernel}}, {"bilinear", true}}));
        ASSERT_GE(run.positions[0].views.size(), 4u);
        const auto& values = run.visibility();
        const auto dark = std::count_if(values.begin(), values.end(), [](float v) { return v < 1; });
        // A tap past a room's edge meets the wall behind it, so kernels darken the corners by their nature; the seams
        // of the cube lie across the flat walls, where every pixel must stay lit.
        int dark_on_flat = 0;
        for (std::size_t pixel = 0; pixel < values.size(); ++pixel) {
            const glm::dvec3 p = glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws;
            const glm::dvec3 size = glm::abs(p);
            const double second =
                std::max({std::min(size.x, size.y), std::min(size.y, size.z), std::min(size.x, size.z)});
            const double reach = 2.5 * (kernel + 1) * 2.0 * 2.2 / 64;
            if (second < 2.0 - reach) dark_on_flat += values[pixel] < 1;
        }
        EXPECT_EQ(dark_on_flat, 0) << kernel << ", of " << dark;
    }
}

}  // namespace
}  // namespace shadow_layers::testing
