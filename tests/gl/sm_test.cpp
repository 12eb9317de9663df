// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// sm on scenes whose shadow is known in closed form: its bias must leave neither acne nor light at contacts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

class SMTest : public ::testing::Test {
protected:
    TechniqueRunner runner_;
};

TEST_F(SMTest, SlopedPlanesHaveNoAcneAtAnySlopeScaleOrMapSize) {
    for (const double scale : {1e-3, 1.0, 1e4})
        for (const double slope_deg : {0.0, 20.0, 60.0, 80.0, 88.0, 89.7}) {
            SceneView view;
            view.width = 160, view.height = 90;
            view.place(view.add("plane", make_plane(8, 5)),
                       glm::scale(placement({0, 0, 0}, slope_deg, {0.3, 1, 0}), glm::dvec3(scale)));
            view.camera = make_camera(glm::dvec3{-2, -3, 5} * scale, {0, 0, 0}, view.width, view.height);
            view.camera.clip_start *= scale, view.camera.clip_end *= scale;
            for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point}) {
                view.scene->lights = {make_light(kind, glm::dvec3{0.01, 0.02, 6} * scale, {0, 0, 0}, 100)};
                const auto run = runner_.render(view, "sm", parameters({{"map_size", std::int64_t{128}}}));
                const auto& values = run.visibility();
                const std::size_t facing = std::size_t(std::count_if(
                    run.frame->normals.begin(), run.frame->normals.end(), [](const glm::vec3& n) { return n.z > 0; }));
                if (facing < values.size() / 10) continue;
                int dark = 0;
                for (std::size_t pixel = 0; pixel < values.size(); ++pixel) {
                    const glm::dvec3 p = glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws;
                    const glm::dvec3 to_light = kind == LightKind::Sun ? glm::normalize(glm::dvec3{0.01, 0.02, 6})
                                                                       : glm::dvec3{0.01, 0.02, 6} * scale - p;
                    const double cosine = glm::dot(glm::dvec3(run.frame->normals[pixel]), glm::normalize(to_light));
                    dark += cosine > 1e-6 && values[pixel] < 1;
                }
                EXPECT_EQ(dark, 0) << "slope " << slope_deg << " scale " << scale << " kind " << int(kind);
            }
        }
}

TEST_F(SMTest, ABoxOnThePlaneLeaksNoLightAtItsFoot) {
    // Unit box that stands on z = 0, sun at 45 degrees from +X: on the ground the shadow is -1 - depth < x < -0.5, |y|
    // < 0.5.
    SceneView view;
    view.width = 320, view.height = 180;
    view.place(view.add("ground", make_plane(10)));
    view.place(view.add("box", make_box({1, 1, 1})), placement({0, 0, 0.5}));
    view.camera = make_camera({-4, -3, 4}, {-0.6, 0, 0}, view.width, view.height, 40);
    view.scene->lights = {make_light(LightKind::Sun, {5, 0, 5}, {0, 0, 0})};
    const auto run = runner_.render(view, "sm", parameters({{"map_size", std::int64_t{1024}}}));
    const LightView& map = run.positions[0].views[0];
    const double texel =
        2.0 / std::abs(glm::length(glm::dvec3(map.lc_from_ws[0][0], map.lc_from_ws[1][0], map.lc_from_ws[2][0]))) /
        map.size_texels;
    int shadowed = 0, wrong = 0;
    for (std::size_t pixel = 0; pixel < run.visibility().size(); ++pixel) {
        if (run.frame->ids[pixel].instance != 0) continue;
        const glm::dvec3 p = glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws;
        const double inside = std::min({p.x + 1.5, -0.5 - p.x, 0.5 - std::abs(p.y)});  // distance into the shadow
        const bool near_border = std::abs(p.x) > 0.5 - 2 * texel && std::abs(inside) < 2 * texel;
        if (near_border || (std::abs(p.x) < 0.5 + 2 * texel && std::abs(p.y) < 0.5 + 2 * texel)) continue;
        shadowed += inside > 0;
        wrong += (inside > 0) != (run.visibility()[pixel] < 0.5f);
    }
    EXPECT_GT(shadowed, 1500);
    EXPECT_EQ(wrong, 0);
}

TEST_F(SMTest, WorksMillionsOfUnitsFromTheOrigin) {
    const auto render = [&](glm::dvec3 far) {
        SceneView view;
        view.width = 200, view.height = 112;
        view.place(view.add("ground", make_plane(10)), placement(far));
        view.place(view.add("box", make_box({1, 1, 1})), placement(far + glm::dvec3{0, 0, 0.5}, 20));
        view.camera = make_camera(far + glm::dvec3{3, -3, 4}, far + glm::dvec3{0, 0, 0.3}, view.width, view.height);
        view.scene->lights = {make_light(LightKind::Spot, far + glm::dvec3{2, 1, 4}, far)};
        return runner_.render(view, "sm").visibility();
    };
    const auto here = render({0, 0, 0}), there = render({1048576, -2097152, 524288});
    int different = 0;
    for (std::size_t pixel = 0; pixel < here.size(); ++pixel) different += here[pixel] != there[pixel];
    EXPECT_LE(different, int(here.size() / 1000));
}

}  // namespace
}  // namespace shadow_layers::testing
