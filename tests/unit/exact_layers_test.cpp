// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exact layers of a half-plane's shadow against their closed forms: a step, a ramp, the part of a disc.
#include "truth/exact_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shadow_layers/error.h"
#include "support/half_plane_scene.h"

namespace shadow_layers::testing {
namespace {

TEST(ExactLayers, HardIsAStep) {
    const auto hard = HalfPlaneScene().compute({});
    for (std::size_t pixel = 0; pixel < hard.size(); ++pixel)
        EXPECT_EQ(hard[pixel], HalfPlaneScene::x_of(pixel) < 0 ? 0.0f : 1.0f) << HalfPlaneScene::x_of(pixel);
}

TEST(ExactLayers, FilteredOnTheReceiverIsARamp) {
    TruthSpec spec;
    spec.kind = TruthKind::Filtered;
    spec.footprint_world = 0.5;
    const auto filtered = HalfPlaneScene().compute(spec);
    // The square may be turned in the plane: between the ramp of a square along the edge and that of one across it.
    for (std::size_t pixel = 0; pixel < filtered.size(); ++pixel) {
        const double x = HalfPlaneScene::x_of(pixel) / spec.footprint_world;
        EXPECT_NEAR(filtered[pixel], std::clamp(x + 0.5, 0.0, 1.0), 0.07) << x;
    }
}

TEST(ExactLayers, FilteredInTheMapIsARampOfSoManyTexels) {
    TruthSpec spec;
    spec.kind = TruthKind::Filtered;
    spec.footprint_texels = 8;
    double widths[2];
    for (const int k : {0, 1}) {
        const auto filtered = HalfPlaneScene().compute(spec, 64 << k);
        double inside = 0;
        for (std::size_t pixel = 0; pixel < std::size_t(HalfPlaneScene::kWidth); ++pixel) {
            inside += filtered[pixel] > 0 && filtered[pixel] < 1;
            EXPECT_NEAR(filtered[pixel] + filtered[std::size_t(HalfPlaneScene::kWidth) - 1 - pixel], 1, 0.13)
                << "mirrored at the edge";
        }
        widths[k] = inside / HalfPlaneScene::kWidth * 2 * HalfPlaneScene::kReach;
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
    const auto soft = HalfPlaneScene().compute(spec);
    const double radius = HalfPlaneScene::kBlockerHeight * std::tan(HalfPlaneScene::kSunAngle / 2);
    for (std::size_t pixel = 0; pixel < soft.size(); ++pixel) {
        const double t = std::clamp(HalfPlaneScene::x_of(pixel) / radius, -1.0, 1.0);
        const double seen = 0.5 + (std::asin(t) + t * std::sqrt(1 - t * t)) / std::numbers::pi;
        EXPECT_NEAR(soft[pixel], seen, 0.07) << t;
    }
}

TEST(ExactLayers, OwnSurfaceOfAHollowIsNoBlocker) {
    // A shallow valley along y: the plane of one side runs into the other, which casts no shadow on it.
    HalfPlaneScene half;
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

TEST(ExactLayers, PixelIsThePartOfItsSquareThatIsLit) {
    for (const double angle : {0.05, 0.4, 0.9, 2.2}) {
        HalfPlaneScene half;
        half.turn_camera(angle, 0.0123);
        const auto pixel_truth = half.compute({TruthKind::Pixel});
        double sum = 0;
        int border = 0;
        for (std::size_t pixel = 0; pixel < pixel_truth.size(); ++pixel) {
            const double part = half.find_part_beyond(pixel, 0);
            if (part <= 0 || part >= 1) {
                EXPECT_EQ(pixel_truth[pixel], part <= 0 ? 0.0f : 1.0f);
                continue;
            }
            EXPECT_NEAR(pixel_truth[pixel], part, 0.04);
            sum += std::abs(pixel_truth[pixel] - part);
            ++border;
        }
        EXPECT_GT(border, 10);
        EXPECT_LT(sum / border, 0.01) << angle;
    }
}

// As a hard layer of many samples: each place of the pixel counts what it sees by itself.
TEST(ExactLayers, PixelCountsBackgroundAsLitAndTurnedAwayAsDark) {
    // A small card before nothing, all in the sheet's shadow; its border runs through the picture.
    HalfPlaneScene card;
    card.turn_camera(0.3, -0.5);
    card.scene->meshes[0] = to_mesh("card", make_plane(1));
    card.scene->instances[0].world_from_object[3] = glm::dvec4(-1.013, 0, 0, 1);
    // A ridge that turns one side away from a low sun, without a sheet.
    HalfPlaneScene ridge;
    ridge.turn_camera(0.3, -0.5);
    MeshData roof;
    for (const float y : {-10.0f, 10.0f})
        for (const float x : {-10.0f, -0.513f, 10.0f}) roof.positions.push_back({x, y, -std::abs(x + 0.513f)});
    roof.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    ridge.scene->meshes[0] = to_mesh("roof", roof);
    ridge.scene->instances.resize(1);
    ridge.scene->lights[0].world_from_light = look_at({10, 0, 1}, {0, 0, 0});
    for (const HalfPlaneScene* scene : {&card, &ridge}) {
        const auto truth = scene->compute({TruthKind::Pixel});
        for (std::size_t pixel = 0; pixel < truth.size(); ++pixel)
            EXPECT_NEAR(truth[pixel], scene->find_part_beyond(pixel, -0.513), 0.04);
    }
}

TEST(ExactLayers, CancelledItThrows) {
    const HalfPlaneScene half;
    const std::atomic<bool> cancelled{true};
    EXPECT_THROW(
        truth::ExactLayers(half.scene, half.camera, HalfPlaneScene::kWidth, HalfPlaneScene::kHeight, 1, cancelled),
        Cancelled);
}

}  // namespace
}  // namespace shadow_layers::testing
