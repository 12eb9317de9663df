// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Shading of the combined picture against closed forms.
#include "frame/clay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace shadow_layers {
namespace {

Light make_light(LightKind kind, const glm::dvec3& place) {
    Light light;
    light.kind = kind;
    light.world_from_light = glm::translate(glm::dmat4(1.0), place);  // looks down
    return light;
}

float shade(const Light& light, const glm::vec3& position = glm::vec3(0), const glm::vec3& normal = {0, 0, 1}) {
    return LightShading(light, glm::dvec3(0)).get_radiance(position, normal);
}

/// A diffuse white patch of a lamp of W watts is as bright as the lamp's light spread over the sphere, by pi.
TEST(LightShading, UnitsAreBlenders) {
    EXPECT_NEAR(shade(make_light(LightKind::Sun, {0, 0, 0})), 1 / M_PI, 1e-6);
    EXPECT_NEAR(shade(make_light(LightKind::Point, {0, 0, 3})), 1 / (4 * M_PI * 9) / M_PI, 1e-7);
    EXPECT_NEAR(shade(make_light(LightKind::Spot, {0, 0, 3})), 1 / (4 * M_PI * 9) / M_PI, 1e-7);
    EXPECT_NEAR(shade(make_light(LightKind::Area, {0, 0, 3})), 1 / (M_PI * 9) / M_PI, 1e-7);
}

/// All light of an area lamp lands on a large floor under it: the integral of the irradiance is its power.
TEST(LightShading, AreaLampKeepsItsPower) {
    const LightShading shading(make_light(LightKind::Area, {0, 0, 1}), glm::dvec3(0));
    double power = 0;
    constexpr double kStep = 0.01;
    for (double r = kStep / 2; r < 100; r += kStep)
        power += M_PI * shading.get_radiance({float(r), 0, 0}, {0, 0, 1}) * 2 * M_PI * r * kStep;
    EXPECT_NEAR(power, 1, 1e-2);
}

TEST(LightShading, FacesTurnedAwayAreDark) {
    for (LightKind kind : {LightKind::Sun, LightKind::Point, LightKind::Spot, LightKind::Area}) {
        EXPECT_EQ(shade(make_light(kind, {0, 0, 3}), glm::vec3(0), {0, 0, -1}), 0);
        EXPECT_GT(shade(make_light(kind, {0, 0, 3})), 0);
    }
    EXPECT_EQ(shade(make_light(LightKind::Area, {0, 0, -3}), glm::vec3(0), {0, 0, -1}), 0);  // behind the lamp
}

TEST(LightShading, SpotFadesAtItsRim) {
    Light spot = make_light(LightKind::Spot, {0, 0, 1});
    spot.spot_angle = 1.0;
    spot.spot_blend = 0.5;
    const auto relative = [&](double angle) {
        const glm::vec3 place(std::tan(angle), 0, 0);
        return shade(spot, place) / shade(make_light(LightKind::Point, {0, 0, 1}), place);
    };
    EXPECT_NEAR(relative(0.0), 1, 1e-5);
    EXPECT_GT(relative(0.45), 0);
    EXPECT_LT(relative(0.45), relative(0.35));
    EXPECT_EQ(relative(0.51), 0);
    spot.spot_blend = 0;
    EXPECT_NEAR(relative(0.49), 1, 1e-5);
    EXPECT_EQ(relative(0.51), 0);
}

TEST(LightShading, TouchingALightStaysFinite) {
    for (LightKind kind : {LightKind::Point, LightKind::Spot, LightKind::Area}) {
        EXPECT_TRUE(std::isfinite(shade(make_light(kind, {0, 0, 0}))));
        EXPECT_TRUE(std::isfinite(shade(make_light(kind, {0, 0, 1e-20}))));
    }
}

TEST(ClayPicture, AddsSurfaceLightAndShadow) {
    auto scene = std::make_shared<Scene>();
    scene->instances.resize(1);
    Frame frame;
    frame.width = 3, frame.height = 1;
    frame.region = {0, 0, 3, 1};
    frame.scene = scene;
    frame.positions_rel.assign(3, glm::vec3(0));
    frame.normals.assign(3, glm::vec3(0, 0, 1));
    frame.ids.assign(3, {0, 0});
    frame.coverage = {1, 1, 0};
    Light light = make_light(LightKind::Sun, {0, 0, 0});
    light.energy = 2;
    light.color = {1, 0.5f, 0};
    ThreadPool threads(1);
    ClayPicture clay(3, 1);
    clay.add_surface(threads, frame, 1);
    const std::vector<float> visibility = {1, 0, 1};
    clay.add_light(threads, frame, light, visibility, 1);
    const Image image = clay.take();
    EXPECT_GT(image.data[0], 0.4f);                                                             // lit
    EXPECT_NEAR((image.data[1] - image.data[5]) / (image.data[0] - image.data[4]), 0.5, 0.05);  // the light's color
    EXPECT_GT(image.data[4], 0.01f);                                                            // in shadow, not black
    EXPECT_LT(image.data[4], 0.1f);
    EXPECT_EQ(image.data[3], 1);
    for (int c = 8; c < 12; ++c) EXPECT_EQ(image.data[std::size_t(c)], 0);  // background
    // Not linked: as if in shadow.
    light.receiver_set = 0;
    ClayPicture unlinked(3, 1);
    unlinked.add_light(threads, frame, light, visibility, 1);
    EXPECT_EQ(unlinked.take().data[0], 0);
}

}  // namespace
}  // namespace shadow_layers
