// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Revectorised percentage-closer filtering against the filtered truth: exact visibility by rays, averaged over the
// points of the receiver's plane that project into the kernel's square of texels. It must be nearer to it than the
// plain filter with as many taps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "support/ray_oracle.h"
#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

/// A box over a plane, turned so that its shadow's borders cross the map's texels at a slant.
SceneView slanted_scene(LightKind kind) {
    SceneView view;
    view.width = 160, view.height = 90;
    view.place(view.add("plane", make_plane(8)));
    view.place(view.add("box", make_box({1.3f, 1.1f, 0.4f})), placement({0, 0, 1}, 22.3));
    view.camera = make_camera({0.4, -0.3, 6}, {0.4, 0.2, 0}, view.width, view.height, 36);
    view.scene->lights = {make_light(kind, {-0.7, -0.5, 5}, {0, 0, 0}, 50)};
    return view;
}

/// What a light's map sees of the plane z = 0.
class PlaneInMap {
public:
    explicit PlaneInMap(const LightView& view)
        : lc_from_ws_(view.lc_from_ws), ws_from_lc_(glm::inverse(view.lc_from_ws)), size_texels_(view.size_texels) {}
    glm::dvec2 to_texel(const glm::dvec3& point_ws) const {
        const glm::dvec4 at = lc_from_ws_ * glm::dvec4(point_ws, 1);
        return (glm::dvec2(at) / at.w + 1.0) * (0.5 * size_texels_);
    }
    glm::dvec3 to_plane(const glm::dvec2& texel) const {
        const glm::dvec2 ndc = texel / (0.5 * size_texels_) - 1.0;
        const auto unproject = [&](double depth_rz) {
            const glm::dvec4 at = ws_from_lc_ * glm::dvec4(ndc, depth_rz, 1);
            return glm::dvec3(at) / at.w;
        };
        const glm::dvec3 nearer = unproject(0.9), farther = unproject(0.1);
        return nearer + (farther - nearer) * (nearer.z / (nearer.z - farther.z));
    }

private:
    glm::dmat4 lc_from_ws_, ws_from_lc_;
    double size_texels_;
};

struct Errors {
    double rms = 0, mean = 0;
    double scatter() const { return std::sqrt(std::max(0.0, rms * rms - mean * mean)); }
};

class FilteredTruthTest : public ::testing::TestWithParam<LightKind> {
protected:
    /// Errors of a technique over the pixels of the plane whose filtered truth is neither lit nor dark.
    Errors measure(const SceneView& view, const std::string& technique, std::int64_t kernel) {
        const auto run = runner_.render(view, technique, parameters({{"map_size", map_size_}, {"kernel", kernel}}));
        const RayOracle oracle(view.scene);
        const LightSample& position = run.positions[0];
        const PlaneInMap map(position.views.at(0));
        Errors errors;
        double count = 0;
        for (std::size_t pixel = 0; pixel < run.visibility().size(); ++pixel) {
            if (run.frame->ids[pixel].instance != 0) continue;
            const glm::dvec3 at = glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws;
            const double truth =
                average(oracle, map, run.frame->ids[pixel], view.scene->lights[0], position, at, kernel);
            if (truth <= 0 || truth >= 1) continue;
            const double error = run.visibility()[pixel] - truth;
            errors.rms += error * error, errors.mean += error;
            ++count;
        }
        EXPECT_GT(count, 80);
        errors.rms = std::sqrt(errors.rms / count), errors.mean /= count;
        std::printf("%-10s %2d x %2d: rms %.4f, mean %+.4f, without it %.4f over %.0f pixels\n", technique.c_str(),
                    int(kernel), int(kernel), errors.rms, errors.mean, errors.scatter(), count);
        return errors;
    }

    static double average(const RayOracle& oracle, const PlaneInMap& map, const PixelIds& ids, const Light& light,
                          const LightSample& position, const glm::dvec3& at, std::int64_t kernel) {
        constexpr int kSamples = 13;
        const glm::dvec2 middle = map.to_texel(at);
        const auto is_lit = [&](double x, double y) {
            return !oracle.is_occluded(map.to_plane(middle + glm::dvec2(x, y) * double(kernel)), ids, light, position);
        };
        // Most pixels are far from any border: corners and middles of the sides tell, for a box so much larger.
        int sum = 0;
        for (int k = 0; k < 9; ++k) sum += is_lit(0.5 * (k % 3) - 0.5, 0.5 * (k / 3) - 0.5);
        if (sum == 0 || sum == 9) return sum / 9;
        sum = 0;
        for (int k = 0; k < kSamples * kSamples; ++k)
            sum += is_lit((k % kSamples + 0.5) / kSamples - 0.5, (k / kSamples + 0.5) / kSamples - 0.5);
        return double(sum) / (kSamples * kSamples);
    }

    TechniqueRunner runner_;
    /// Texels of some two pixels.
    std::int64_t map_size_ = GetParam() == LightKind::Sun ? 40 : 96;
};

TEST_P(FilteredTruthTest, RevectorisedFiltersAreNearerThanThePlainOne) {
    const SceneView view = slanted_scene(GetParam());
    for (const std::int64_t kernel : {3, 4, 7}) {
        const Errors plain = measure(view, "pcf", kernel), smooth = measure(view, "rpcf_rsmss", kernel),
                     hard = measure(view, "rpcf_smsr", kernel);
        EXPECT_LT(smooth.rms, 0.7 * plain.rms) << kernel;
        EXPECT_LT(std::abs(smooth.mean), 0.03) << kernel;
        // Hard revectorisation moves borders by half a texel, on purpose; what is left is compared.
        EXPECT_LT(hard.scatter(), plain.scatter()) << kernel;
        EXPECT_LT(hard.mean, 0) << kernel;
    }
}

INSTANTIATE_TEST_SUITE_P(Lights, FilteredTruthTest, ::testing::Values(LightKind::Sun, LightKind::Spot),
                         [](const auto& item) { return item.param == LightKind::Sun ? "sun" : "spot"; });

}  // namespace
}  // namespace shadow_layers::testing
