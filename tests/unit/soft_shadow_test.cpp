// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Soft shadows by rays against hard ones added up, and against closed forms with the error that they tell.
#include "truth/soft_shadow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lights/facing.h"
#include "lights/light_shape.h"
#include "support/half_plane_scene.h"
#include "support/ray_oracle.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

using truth::LitEstimate;
using truth::LitPart;
using truth::SampleShadows;
using truth::ShapeShadows;

Light sized_light(LightKind kind) {
    Light light = make_light(kind, {1.6, 1.2, 3.4}, {0, 0, 0.4}, 80);
    light.radius = 0.4, light.sun_angle = 0.4, light.area_size = {1.2, 0.6};
    return light;
}

/// The definition word by word: weights by the product's rule, hard layers by the oracle.
std::vector<double> add_hard_layers(const RayOracle& oracle, const Frame& frame, const Light& light,
                                    const std::vector<LightSample>& samples) {
    std::vector<double> lit(frame.pixel_count()), all(frame.pixel_count()), plain(frame.pixel_count());
    for (const LightSample& sample : samples) {
        const std::vector<float> mask = oracle.compute_visibility(frame, light, sample);
        const FacingRule rule(frame, light, sample);
        for (std::size_t pixel = 0; pixel < mask.size(); ++pixel) {
            const double weight = rule.classify(pixel) == Facing::Undecided ? rule.get_weight(pixel) : 0;
            lit[pixel] += weight * double(mask[pixel]), all[pixel] += weight;
            plain[pixel] += double(mask[pixel]) / double(samples.size());
        }
    }
    for (std::size_t pixel = 0; pixel < lit.size(); ++pixel)
        lit[pixel] = all[pixel] > 0 ? lit[pixel] / all[pixel] : plain[pixel];
    return lit;
}

TEST(SampleShadows, AreTheWeightedMeanOfHardLayers) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        SceneView view = make_soup_scene(3 + unsigned(kind), 120, 68);
        view.scene->lights = {sized_light(kind)};
        const Light& light = view.scene->lights[0];
        const RayOracle oracle(view.scene);
        const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
        const auto samples = sample_light_shape(light, 16, LightPattern::Spiral);
        const SampleShadows shadows(oracle, frame, light, samples);
        const auto expected = add_hard_layers(oracle, frame, light, samples);
        std::size_t penumbra = 0, uncertain = 0;
        for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
            const LitPart part = shadows.find_lit_part(pixel);
            EXPECT_NEAR(part.decided, expected[pixel], 2e-5) << pixel;
            EXPECT_GE(expected[pixel], part.least - 1e-12);
            EXPECT_LE(expected[pixel], part.most + 1e-12);
            penumbra += part.decided > 0 && part.decided < 1;
            uncertain += part.most - part.least > 0.5 * part.step;
            EXPECT_TRUE(part.bits == 0 || part.step >= 1.0 / 16 - 1e-9);
        }
        EXPECT_GT(penumbra, 500u);
        EXPECT_LT(uncertain, frame.pixel_count() / 500);
    }
}

/// A bit that is turned over leaves what ties may make of the part.
TEST(SampleShadows, AWrongBitIsOutsideOfTheRange) {
    SceneView view = make_soup_scene(5, 96, 54);
    view.scene->lights = {sized_light(LightKind::Point)};
    const RayOracle oracle(view.scene);
    const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
    const auto samples = sample_light_shape(view.scene->lights[0], 64, LightPattern::Spiral);
    const SampleShadows shadows(oracle, frame, view.scene->lights[0], samples);
    std::size_t found = 0, looked_at = 0;
    for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
        const LitPart part = shadows.find_lit_part(pixel);
        if (part.bits < 64) continue;
        ++looked_at;
        // Of 64 points of a small ball the least brings some tenths of the most.
        const double wrong = part.decided + (part.decided > 0.5 ? -0.5 : 0.5) * part.step;
        found += wrong < part.least || wrong > part.most;
    }
    EXPECT_GT(looked_at, 1000u);
    EXPECT_GT(found, looked_at - looked_at / 200);
}

TEST(ShapeShadows, AreTheClosedFormWithinTheirStandardError) {
    const HalfPlaneScene half;
    const RayOracle oracle(half.scene);
    const Frame frame = oracle.make_frame(half.camera, HalfPlaneScene::kWidth, HalfPlaneScene::kHeight);
    const ShapeShadows shadows(oracle, frame, half.scene->lights[0]);
    const double radius = HalfPlaneScene::kBlockerHeight * std::tan(HalfPlaneScene::kSunAngle / 2);
    double scores = 0, largest = 0;
    int penumbra = 0;
    for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
        const double t = std::clamp(HalfPlaneScene::x_of(pixel) / radius, -1.0, 1.0);
        // Even in solid angle is even over the plane's disc to 1 % for a sun of this size.
        const double seen = 0.5 + (std::asin(t) + t * std::sqrt(1 - t * t)) / std::numbers::pi;
        const LitEstimate estimate = shadows.estimate_lit_part(pixel);
        EXPECT_NEAR(estimate.mean, seen, 0.02) << t;
        if (std::abs(t) > 0.9) continue;
        ++penumbra;
        EXPECT_GT(estimate.standard_error, 0);
        scores += std::pow((estimate.mean - seen) / std::max(estimate.standard_error, 0.002), 2);
        largest = std::max(largest, estimate.standard_error);
    }
    EXPECT_GT(penumbra, 80);
    EXPECT_LT(scores / penumbra, 2.5) << "the standard error is told too small";
    EXPECT_LT(largest, 0.01);
}

/// A bulb is a disc turned to each receiver, an area light weighs by its cosines and its distance.
TEST(ShapeShadows, AgreeWithManySamplesOfTheProductsShapes) {
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Area, LightKind::Sun}) {
        SceneView view = make_soup_scene(8, 48, 27);
        view.scene->lights = {sized_light(kind)};
        view.scene->lights[0].radius = 0.15;
        const Light& light = view.scene->lights[0];
        const RayOracle oracle(view.scene);
        const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
        const auto samples = sample_light_shape(light, 512, LightPattern::Spiral);
        const SampleShadows at_samples(oracle, frame, light, samples);
        const ShapeShadows of_shape(oracle, frame, light);
        double sum = 0, bias = 0;
        int penumbra = 0;
        for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
            const double part = at_samples.find_lit_part(pixel).decided;
            const LitEstimate estimate = of_shape.estimate_lit_part(pixel);
            EXPECT_NEAR(estimate.mean, part, 0.05 + 6 * estimate.standard_error) << int(kind) << ", " << pixel;
            if (part <= 0 || part >= 1) continue;
            ++penumbra;
            sum += std::abs(estimate.mean - part), bias += estimate.mean - part;
        }
        EXPECT_GT(penumbra, 100);
        EXPECT_LT(sum / penumbra, 0.012) << int(kind);
        EXPECT_LT(std::abs(bias) / penumbra, 0.004) << int(kind);
    }
}

}  // namespace
}  // namespace shadow_layers::testing
