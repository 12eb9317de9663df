// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// More samples come nearer to the light's whole shape, whether the light has them or the pixel. No pattern of N points
// tells straight borders at every angle better than as N^(-3/4) (Beck); independent points do as N^(-1/2).
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gl/shared_session.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

struct Shape {
    const char* name;
    LightKind kind;
    bool round;
};
const Shape kShapes[] = {{"rectangle", LightKind::Area, false},
                         {"ellipse", LightKind::Area, true},
                         {"ball", LightKind::Point, false},
                         {"cone of a spot", LightKind::Spot, false},
                         {"sun", LightKind::Sun, false}};

SceneView make_view(const Shape& shape) {
    SceneView view = make_soup_scene(5, 160, 90, 40);
    Light light = make_light(shape.kind, {1.6, 1.2, 4.2}, {0, 0, 0.4}, 120);
    light.radius = 0.6, light.sun_angle = 0.25, light.area_size = {1.3, 0.9}, light.area_round = shape.round;
    view.scene->lights = {light};
    return view;
}

/// All of a pixel's samples lie at its centre, so that the light alone is sampled better.
std::vector<float> render(const SceneView& view, int light_samples, int picture_samples, const char* pattern) {
    RenderRequest request;
    request.scene = view.scene, request.camera = view.camera;
    request.width = view.width, request.height = view.height;
    request.combined = false;
    request.samples = picture_samples;
    request.filter.width_px = 1e-9;
    ParameterValues values;
    values.set("light_samples", std::int64_t{light_samples});
    values.set("pattern", std::string(pattern));
    request.jobs = {{0, "soft", values}};
    std::vector<float> visibility;
    shared_session().render(request, [&](Layer&& layer) { visibility = layer.channels.at("visibility").data; });
    return visibility;
}

/// Root mean square over the penumbra.
double find_error(const std::vector<float>& picture, const std::vector<float>& truth) {
    double sum = 0;
    int count = 0;
    for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
        if (truth[pixel] < 0.005f || truth[pixel] > 0.995f) continue;
        const double off = double(picture[pixel]) - double(truth[pixel]);
        sum += off * off, ++count;
    }
    EXPECT_GT(count, 1000);
    return std::sqrt(sum / std::max(count, 1));
}

/// The power of N that the error falls with, at least. One set of points for a ball must tell it from all sides.
double find_power(LightKind kind) { return kind == LightKind::Point || kind == LightKind::Spot ? 0.55 : 0.65; }

class SoftConvergence : public ::testing::TestWithParam<Shape> {};

TEST_P(SoftConvergence, SamplesOfThePixelAddToThoseOfTheLight) {
    const SceneView view = make_view(GetParam());
    const std::vector<float> truth = render(view, 1024, 16, "rotated");
    const double few = find_error(render(view, 64, 1, "rotated"), truth);
    const double many = find_error(render(view, 64, 16, "rotated"), truth);
    std::printf("%s: 64 %.5f, 16 x 64 %.5f\n", GetParam().name, few, many);
    EXPECT_GT(few, 1.0 / 256) << "nothing to improve";
    EXPECT_LT(many, few / std::pow(16, find_power(GetParam().kind)));
    // Without the shifts the pixel's samples all tell the same.
    const double fixed = find_error(render(view, 64, 16, "fixed"), truth);
    EXPECT_GT(fixed, 0.9 * find_error(render(view, 64, 1, "fixed"), truth));
}

TEST_P(SoftConvergence, SamplesOfTheLightComeNearerToItsShape) {
    const SceneView view = make_view(GetParam());
    const std::vector<float> truth = render(view, 1024, 16, "rotated");
    const double few = find_error(render(view, 16, 1, "fixed"), truth);
    for (const int times : {4, 16}) {
        const double more = find_error(render(view, 16 * times, 1, "fixed"), truth);
        std::printf("%s: 16 %.5f, %d %.5f\n", GetParam().name, few, 16 * times, more);
        EXPECT_LT(more, few / std::pow(times, find_power(GetParam().kind))) << times;
    }
}

INSTANTIATE_TEST_SUITE_P(AllShapes, SoftConvergence, ::testing::ValuesIn(kShapes), [](const auto& item) {
    std::string name = item.param.name;
    for (char& letter : name)
        if (letter == ' ') letter = '_';
    return name;
});

}  // namespace
}  // namespace shadow_layers::testing
