// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Progress within a layer, and what a cancel from there does.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "gl/shared_session.h"
#include "shadow_layers/error.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

struct Told {
    double fraction;
    std::string text;
};

/// One slow layer: a light as large as the scene, seen by more than a second's work.
RenderRequest make_slow_request(const char* technique, const char* count, int samples) {
    SceneView view = make_soup_scene(3, 960, 540, 300);
    Light light = make_light(LightKind::Area, {1.5, 1, 5}, {0, 0, 0.3});
    light.name = "window", light.area_size = {5, 4};
    view.scene->lights = {light};
    RenderRequest request;
    request.scene = view.scene, request.camera = view.camera;
    request.width = view.width, request.height = view.height;
    ParameterValues values;
    values.set(count, std::int64_t{samples});
    request.jobs = {{0, technique, values}};
    return request;
}

/// What is told of a render's one layer, from its begin on.
std::vector<Told> listen(const RenderRequest& request) {
    std::vector<Told> told;
    shared_session().render(
        request, [](Layer&&) {},
        [&](double fraction, const std::string& text) {
            if (text.find("window") != std::string::npos) told.push_back({fraction, text});
        });
    return told;
}

void expect_many_and_rising(const std::vector<Told>& told) {
    EXPECT_GT(told.size(), 5u);
    for (std::size_t i = 1; i < told.size(); ++i) {
        EXPECT_GE(told[i].fraction, told[i - 1].fraction);
        EXPECT_EQ(told[i].text, told[0].text);
    }
    // The frame is the first half of this render, its only layer the second.
    EXPECT_GE(told.front().fraction, 0.5);
    EXPECT_LT(told.front().fraction, 0.7);
    EXPECT_GT(told.back().fraction, 0.8);
    EXPECT_LE(told.back().fraction, 1.0);
}

TEST(Progress, ASlowSoftLayerTellsHowFarItIs) {
    expect_many_and_rising(listen(make_slow_request("soft", "light_samples", 1024)));
}

TEST(Progress, ALayerOfManyHardShadowsTellsHowFarItIs) {
    expect_many_and_rising(listen(make_slow_request("multi", "positions", 64)));
}

TEST(Progress, ACancelWithinALayerEndsIt) {
    for (const auto& [technique, count, samples] :
         {std::tuple{"soft", "light_samples", 1024}, {"multi", "positions", 64}}) {
        double cancelled_at = 0, last = 0;
        EXPECT_THROW(shared_session().render(
                         make_slow_request(technique, count, samples), [](Layer&&) { ADD_FAILURE() << "a layer"; },
                         [&](double fraction, const std::string&) {
                             last = fraction;
                             if (cancelled_at > 0 || fraction <= 0.5) return;
                             cancelled_at = fraction;
                             shared_session().cancel();
                         }),
                     Cancelled)
            << technique;
        EXPECT_GT(cancelled_at, 0.5) << technique;
        EXPECT_LT(cancelled_at, 0.9) << "the layer was as good as done";
        EXPECT_EQ(last, cancelled_at) << technique;
    }
}

}  // namespace
}  // namespace shadow_layers::testing
