// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exact layers of a half-plane's shadow against their closed forms: a step, a ramp, the part of a disc.
#include "truth/exact_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shadow_layers/error.h"
#include "support/technique_scenes.h"

namespace shadow_layers::testing {
namespace {

constexpr int kWidth = 64, kHeight = 8;
constexpr double kReach = 0.8;  // half the width of what the camera sees
constexpr double kBlockerHeight = 1, kSunAngle = 0.4;

// A floor seen from straight above; a sheet over its half x < 0 that only casts; a sun straight above.
struct HalfPlane {
    std::shared_ptr<Scene> scene = std::make_shared<Scene>();
    Camera camera;

    HalfPlane() {
        scene->meshes = {to_mesh("floor", make_plane(20)), to_mesh("sheet", make_plane(10))};
        Instance floor, sheet;
        floor.flags = kInstanceCamera | kInstanceShadow;
        sheet.mesh = 1;
        sheet.flags = kInstanceShadow;
        sheet.world_from_object[3] = glm::dvec4(-5, 0, kBlockerHeight, 1);
        scene->instances = {floor, sheet};
        Light sun;
        sun.name = "Sun";
        sun.kind = LightKind::Sun;
        sun.sun_angle = kSunAngle;
        scene->lights = {sun};
        camera.perspective = false;
        camera.window = {-kReach, kReach, -0.1, 0.1};
        camera.clip_start = 0.1, camera.clip_end = 100;
        camera.world_from_camera = glm::dmat4(1.0);
        camera.world_from_camera[3] = glm::dvec4(0, 0, 5, 1);
    }

    static double x_of(std::size_t pixel) {
        return ((double(pixel % std::size_t(kWidth)) + 0.5) / kWidth * 2 - 1) * kReach;
    }
    std::vector<float> compute(const TruthSpec& spec, int map_size = 256) const {
        const std::atomic<bool> cancelled{false};
        return truth::ExactLayers(scene, camera, kWidth, kHeight, 1, cancelled).compute(0, spec, map_size);
    }
};

TEST(ExactLayers, HardIsAStep) {
    const auto hard = HalfPlane().compute({});
    for (std::size_t pixel = 0; pixel < hard.size(); ++pixel)
        EXPECT_EQ(hard[pixel], HalfPlane::x_of(pixel) < 0 ? 0.0f : 1.0f) << HalfPlane::x_of(pixel);
}

TEST(ExactLayers, FilteredOnTheReceiverIsARamp) {
    TruthSpec spec;
    spec.kind = TruthKind::Filtered;
    spec.footprint_world = 0.5;
    const auto filtered = HalfPlane().compute(spec);
    // The square may be turned in the plane: between the ramp of a square along the edge and that of one across it.
    for (std::size_t pixel = 0; pixel < filtered.size(); ++pixel) {
        const double x = HalfPlane::x_of(pixel) / spec.footprint_world;
        EXPECT_NEAR(filtered[pixel], std::clamp(x + 0.5, 0.0, 1.0), 0.07) << x;
    }
}

TEST(ExactLayers, FilteredInTheMapIsARampOfSoManyTexels) {
    TruthSpec spec;
    spec.kind = TruthKind::Filtered;
    spec.footprint_texels = 8;
    double widths[2];
    for (const int k : {0, 1}) {
        const auto filtered = HalfPlane().compute(spec, 64 << k);
        double inside = 0;
        for (std::size_t pixel = 0; pixel < std::size_t(kWidth); ++pixel) {
            inside += filtered[pixel] > 0 && filtered[pixel] < 1;
            EXPECT_NEAR(filtered[pixel] + filtered[std::size_t(kWidth) - 1 - pixel], 1, 0.13) << "mirrored at the edge";
        }
        widths[k] = inside / kWidth * 2 * kReach;
    }
    // The map holds what the camera sees, 1.6 wide and some texels more: eight of 64 are 0.2 to 0.25 (turned: 1.4
    // more).
    EXPECT_GT(widths[0], 0.15);
    EXPECT_LT(widths[0], 0.4);
    EXPECT_NEAR(widths[1] / widths[0], 0.5, 0.15);
}

TEST(ExactLayers, SoftIsThePartOfTheSunsDisc) {
    TruthSpec spec;
    spec.kind = TruthKind::Soft;
    const auto soft = HalfPlane().compute(spec);
    const double radius = kBlockerHeight * std::tan(kSunAngle / 2);
    for (std::size_t pixel = 0; pixel < soft.size(); ++pixel) {
        const double t = std::clamp(HalfPlane::x_of(pixel) / radius, -1.0, 1.0);
        const double seen = 0.5 + (std::asin(t) + t * std::sqrt(1 - t * t)) / std::numbers::pi;
        EXPECT_NEAR(soft[pixel], seen, 0.07) << t;
    }
}

TEST(ExactLayers, OwnSurfaceOfAHollowIsNoBlocker) {
    // A shallow valley along y: the plane of one side runs into the other, which casts no shadow on it.
    HalfPlane half;
    MeshData valley;
    for (const float y : {-10.0f, 10.0f})
        for (const float x : {-10.0f, 0.0f, 10.0f}) valley.positions.push_back({x, y, std::abs(x) * 0.1f});
    valley.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    half.scene->meshes = {to_mesh("valley", valley)};
    half.scene->instances.resize(1);
    TruthSpec spec;
    spec.kind = TruthKind::Filtered;
    spec.footprint_world = 0.5;
    for (const float value : half.compute(spec)) EXPECT_EQ(value, 1.0f);
}

TEST(ExactLayers, CancelledItThrows) {
    const HalfPlane half;
    const std::atomic<bool> cancelled{true};
    EXPECT_THROW(truth::ExactLayers(half.scene, half.camera, kWidth, kHeight, 1, cancelled), Cancelled);
}

}  // namespace
}  // namespace shadow_layers::testing
