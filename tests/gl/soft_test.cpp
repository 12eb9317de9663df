// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// soft against rays: the weighted mean of exact rays to the same samples, to the rounding of that mean, so that no bit
// may differ, whatever the scene, the light and its size.
#include <gtest/gtest.h>

#include <cmath>

#include "lights/facing.h"
#include "lights/light_shape.h"
#include "support/ray_comparison.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

Light make_sized_light(LightKind kind, double size, const glm::dvec3& place, const glm::dvec3& target = {0, 0, 0.3},
                       double cone = 90) {
    Light light = make_light(kind, place, target, cone);
    light.radius = 0.5 * size;
    light.sun_angle = size * 0.2;
    light.area_size = {size, 0.7 * size};
    light.area_round = false;
    return light;
}

/// A weighted mean moves by more than this with each bit, unless its sample brings next to nothing.
constexpr double kRounding = 3e-6;

struct SoftComparison {
    int different = 0, lit = 0, penumbra = 0, dark = 0;
    double largest = 0;
};

/// The mean that `soft` stands for, by rays.
std::vector<double> find_truth(const Frame& frame, const Light& light, int count, ThreadPool& threads) {
    const truth::RayOracle oracle(frame.scene);
    std::vector<double> sum(frame.pixel_count()), weights(frame.pixel_count());
    std::vector<LightSample> samples = sample_light_shape(light, count, LightPattern::Spiral);
    for (const LightSample& sample : samples) {
        const std::vector<float> hard = oracle.compute_visibility(frame, light, sample, &threads);
        const FacingRule rule(frame, light, sample);
        for (std::size_t pixel = 0; pixel < sum.size(); ++pixel) {
            double weight = 1e-20;
            if (rule.classify(pixel) == Facing::Undecided) weight = std::max(weight, rule.get_weight(pixel));
            sum[pixel] += weight * double(hard[pixel]);
            weights[pixel] += weight;
        }
    }
    for (std::size_t pixel = 0; pixel < sum.size(); ++pixel) sum[pixel] /= weights[pixel];
    return sum;
}

class Soft : public ::testing::Test {
protected:
    SoftComparison compare(SceneView view, const Light& light, int count = 64) {
        view.scene->lights = {light};
        const TechniqueRun run = runner_.render(view, "soft", parameters({{"light_samples", std::int64_t{count}}}));
        const std::vector<double> truth = find_truth(*run.frame, light, count, runner_.engine().threads());
        SoftComparison found;
        for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
            const double off = std::abs(truth[pixel] - double(run.visibility()[pixel]));
            found.largest = std::max(found.largest, off);
            found.different += !(off <= kRounding);
            ++(truth[pixel] >= 1 ? found.lit : truth[pixel] <= 0 ? found.dark : found.penumbra);
        }
        return found;
    }
    TechniqueRunner runner_;
};

TEST_F(Soft, EqualsRaysOnSoups) {
    for (unsigned seed = 1; seed <= 4; ++seed)
        for (const LightKind kind : kAllLightKinds)
            for (const double size : {0.05, 0.8, 4.0}) {
                const SoftComparison found =
                    compare(make_soup_scene(seed), make_sized_light(kind, size, {1.5, 1.0, 5.0}));
                EXPECT_EQ(found.different, 0)
                    << "seed " << seed << ", kind " << int(kind) << ", size " << size << ", largest " << found.largest;
                EXPECT_GT(found.penumbra, 200);
            }
}

}  // namespace
}  // namespace shadow_layers::testing
