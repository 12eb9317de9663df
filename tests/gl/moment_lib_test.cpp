// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/lib/moment_lib.glsl and linear_depth_lib.glsl against double precision: bounds over random mixtures of
// depths, and the Hamburger solution by another way than the shader's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "support/glsl_lib_runner.h"

namespace shadow_layers::testing {
namespace {

/// Depths in [-1, 1] with their parts of a footprint.
struct Mixture {
    std::vector<double> depths, parts;
    double moment(int power) const {
        double sum = 0;
        for (std::size_t k = 0; k < depths.size(); ++k) sum += parts[k] * std::pow(depths[k], power);
        return sum;
    }
    glm::vec4 moments() const { return {moment(1), moment(2), moment(3), moment(4)}; }
    double part_before(double depth) const {
        double sum = 0;
        for (std::size_t k = 0; k < depths.size(); ++k) sum += depths[k] < depth ? parts[k] : 0;
        return sum;
    }
};

Mixture make_mixture(std::mt19937& random, int surfaces) {
    std::uniform_real_distribution<double> depth(-1, 1), part(0.05, 1);
    Mixture mixture;
    double sum = 0;
    for (int k = 0; k < surfaces; ++k) {
        mixture.depths.push_back(depth(random)), mixture.parts.push_back(part(random));
        sum += mixture.parts.back();
    }
    for (double& weight : mixture.parts) weight /= sum;
    return mixture;
}

struct Reference {
    double before = 0;     ///< mass before the depth
    double condition = 0;  ///< determinant of the Hankel matrix: small where moments say little
};

/// The three masses with the moments b, one of them at `depth`: the other two are the zeros of q = x^2 + p x + r with
/// E (x - depth) q = E x (x - depth) q = 0, and the weights follow from the first three moments.
Reference solve_hamburger(const std::array<double, 5>& b, double depth) {
    Reference result;
    result.condition =
        b[2] * b[4] - b[3] * b[3] - b[1] * (b[1] * b[4] - b[3] * b[2]) + b[2] * (b[1] * b[3] - b[2] * b[2]);
    const auto shifted = [&](int k) { return b[std::size_t(k) + 1] - depth * b[std::size_t(k)]; };
    const double a0 = shifted(1), a1 = shifted(0), a2 = -shifted(2), c0 = shifted(2), c1 = shifted(1), c2 = -shifted(3);
    const double det = a0 * c1 - a1 * c0;
    const double p = (a2 * c1 - a1 * c2) / det, r = (a0 * c2 - a2 * c0) / det;
    const double root = std::sqrt(std::max(p * p - 4 * r, 0.0));
    const std::array<double, 3> x{(-p - root) / 2, (-p + root) / 2, depth};
    for (int k = 0; k < 2; ++k) {
        const double u = x[std::size_t(1 - k)], v = x[2], own = x[std::size_t(k)];
        if (own < depth) result.before += (u * v - b[1] * (u + v) + b[2]) / ((own - u) * (own - v));
    }
    return result;
}

std::array<double, 5> biased(const glm::vec4& moments, double bias) {
    const std::array<double, 4> spread{0, 0.375, 0, 0.375};
    std::array<double, 5> b{1};
    for (int k = 0; k < 4; ++k) b[std::size_t(k) + 1] = (1 - bias) * moments[k] + bias * spread[std::size_t(k)];
    return b;
}

constexpr double kBias = 1e-6;
const char* const kBlockBound = "outputs[i] = vec4(block_bound(inputs[2*i], inputs[2*i+1].x, inputs[2*i+1].y));";

TEST(MomentLib, FourMomentsGiveALowerBoundAndEqualTheDoubleSolution) {
    GlslLibRunner runner;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    std::vector<Mixture> mixtures;
    std::vector<glm::vec4> items;
    for (int k = 0; k < 4000; ++k) {
        mixtures.push_back(make_mixture(random, 1 + k % 6));
        items.push_back(mixtures.back().moments());
        items.emplace_back(anywhere(random), kBias, 0, 0);
    }
    const auto out = runner.run("lib/moment_lib.glsl", kBlockBound, items, int(mixtures.size()), 1);
    int compared = 0;
    for (std::size_t k = 0; k < mixtures.size(); ++k) {
        const double depth = items[2 * k + 1].x;
        ASSERT_LE(out[k].x, mixtures[k].part_before(depth) + 0.02) << k;
        const Reference truth = solve_hamburger(biased(items[2 * k], kBias), depth);
        if (truth.condition < 1e-4) continue;
        ++compared;
        ASSERT_NEAR(out[k].x, std::clamp((truth.before - kBias) / (1 - kBias), 0.0, 1.0), 2e-3) << k;
    }
    EXPECT_GT(compared, 1000);
}

TEST(MomentLib, TwoSurfacesAreSolvedExactly) {
    GlslLibRunner runner;
    std::mt19937 random(6);
    std::vector<Mixture> mixtures;
    std::vector<glm::vec4> items;
    while (mixtures.size() < 2000) {
        const Mixture mixture = make_mixture(random, 2);
        const double farther = std::max(mixture.depths[0], mixture.depths[1]);
        if (std::abs(mixture.depths[0] - mixture.depths[1]) < 0.2) continue;
        mixtures.push_back(mixture);
        items.push_back(mixture.moments());
        // On the farther one, a little before it: what lies at the depth itself does not block.
        items.emplace_back(farther - 1e-4, kBias, 0, 0);
    }
    const auto blocked = runner.run("lib/moment_lib.glsl", kBlockBound, items, int(mixtures.size()), 1);
    const auto lit =
        runner.run("lib/moment_lib.glsl",
                   "outputs[i] = vec4(chebyshev_bound(inputs[2*i].x, inputs[2*i].y, inputs[2*i+1].x, 1e-7));", items,
                   int(mixtures.size()), 1);
    for (std::size_t k = 0; k < mixtures.size(); ++k) {
        const double truth = mixtures[k].part_before(items[2 * k + 1].x);
        EXPECT_NEAR(blocked[k].x, truth, 5e-3) << k;
        EXPECT_NEAR(1 - lit[k].x, truth, 5e-3) << k;
    }
}

TEST(MomentLib, ASingleSurfaceBlocksAllOrNothing) {
    GlslLibRunner runner;
    std::vector<glm::vec4> items;
    for (int k = 0; k <= 200; ++k) {
        const double z = -1 + 0.01 * k;
        const Mixture mixture{{z}, {1.0}};
        for (const double beside : {-0.05, -1e-6, 0.05}) {
            items.push_back(mixture.moments());
            items.emplace_back(z + beside, kBias, 0, 0);
        }
    }
    const int count = int(items.size() / 2);
    const auto out = runner.run("lib/moment_lib.glsl", kBlockBound, items, count, 1);
    for (int k = 0; k < count; ++k) EXPECT_NEAR(out[std::size_t(k)].x, k % 3 == 2 ? 1 : 0, 2e-3) << k;
}

TEST(MomentLib, ChebyshevAndTheExponentialAreUpperBoundsOfWhatIsLit) {
    GlslLibRunner runner;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    std::vector<Mixture> mixtures;
    std::vector<glm::vec4> items;
    const double exponent = 20;
    for (int k = 0; k < 2000; ++k) {
        mixtures.push_back(make_mixture(random, 1 + k % 5));
        items.push_back(mixtures.back().moments());
        items.emplace_back(anywhere(random), 0, 0, 0);
    }
    const auto out = runner.run("lib/moment_lib.glsl",
                                "float z = inputs[2*i+1].x;\n"
                                "outputs[i].x = chebyshev_bound(inputs[2*i].x, inputs[2*i].y, z, 1e-7);\n"
                                "outputs[i].y = encode_exponential(z, vec2(20.0)).x;\n"
                                "outputs[i].zw = warp_depth(z, vec2(20.0, 5.0));",
                                items, 2000, 1);
    for (std::size_t k = 0; k < mixtures.size(); ++k) {
        const double depth = items[2 * k + 1].x, lit = 1 - mixtures[k].part_before(depth);
        ASSERT_GE(out[k].x, lit - 1e-4) << k;
        double mean = 0;
        for (std::size_t s = 0; s < mixtures[k].depths.size(); ++s)
            mean += mixtures[k].parts[s] * std::exp(exponent * mixtures[k].depths[s]);
        ASSERT_GE(mean / out[k].y, lit - 1e-4) << k;
        ASSERT_NEAR(out[k].z / std::exp(20 * depth), 1, 1e-5) << k;
        ASSERT_NEAR(out[k].w / -std::exp(-5 * depth), 1, 1e-5) << k;
    }
}

TEST(MomentLib, PackedMomentsFillTheUnitRangeAndComeBack) {
    GlslLibRunner runner;
    std::vector<glm::vec4> items;
    for (int k = 0; k <= 4000; ++k) items.emplace_back(-1 + k / 2000.0, 0, 0, 0);
    const auto out =
        runner.run("lib/moment_lib.glsl",
                   "float z = inputs[i].x;\n"
                   "vec4 fitted = encode_moments_fixed(z, vec2(0.0));\n"
                   "outputs[4*i] = fitted;\n"
                   "outputs[4*i+1] = unpack_moments(fitted);\n"
                   "outputs[4*i+2] = unpack_moments(round(fitted * 65535.0) / 65535.0);\n"
                   "vec2 stored = encode_variance_fixed(z, vec2(0.0)).xy;\n"
                   "outputs[4*i+3] = vec4(stored, decode_variance_fixed(round(stored * 65535.0) / 65535.0));",
                   items, int(items.size()), 4);
    glm::vec4 least(1), most(0);
    for (std::size_t k = 0; k < items.size(); ++k) {
        const double z = items[k].x;
        const std::array<double, 4> powers{z, z * z, z * z * z, z * z * z * z};
        for (int c = 0; c < 4; ++c) {
            least[c] = std::min(least[c], out[4 * k][c]), most[c] = std::max(most[c], out[4 * k][c]);
            ASSERT_NEAR(out[4 * k + 1][c], powers[std::size_t(c)], 1e-6) << z;
            ASSERT_NEAR(out[4 * k + 2][c], powers[std::size_t(c)], c % 2 == 0 ? 1.7e-5 : 1.0e-5) << z;
        }
        ASSERT_NEAR(out[4 * k + 3].z, z, 1.6e-5);
        ASSERT_NEAR(out[4 * k + 3].w, z * z, 0.8e-5);
    }
    for (int c = 0; c < 4; ++c) {
        EXPECT_NEAR(least[c], 0, 1e-6) << c;
        EXPECT_NEAR(most[c], 1, 1e-6) << c;
    }
}

TEST(LinearDepthLib, DepthsAreLinearInTheDistanceForAnyRange) {
    GlslLibRunner runner;
    std::vector<glm::vec4> items;
    std::vector<double> truth;
    for (const double ratio : {1.0, 1.001, 3.0, 1e3, 1e6})  // far / near; 1 stands for a parallel view
        for (int k = 0; k < 100; ++k) {
            const double t = k / 100.0;  // from near to far
            const double w = 1 + t * (ratio - 1);
            const double depth_rz = ratio > 1 ? (ratio - w) / ((ratio - 1) * w) : 1 - t;
            items.emplace_back(depth_rz, ratio - 1, 0, 0);
            const double s = items.back().y, rz = items.back().x;
            truth.push_back(1.8 * (1 - rz) / (1 + s * rz) - 1);
            EXPECT_NEAR(truth.back(), 1.8 * t - 1, 2e-5);
        }
    items.emplace_back(0, 5, 0, 0);
    const auto out =
        runner.run("lib/linear_depth_lib.glsl",
                   "float rz = inputs[i].x, s = inputs[i].y;\n"
                   "outputs[i] = vec4(linear_depth(rz, s), texel_depth(rz, s), linear_depth_slope(rz, s), 0);",
                   items, int(items.size()), 1);
    for (std::size_t k = 0; k < truth.size(); ++k) {
        EXPECT_NEAR(out[k].x, truth[k], 3e-7) << k;
        if (items[k].x > 0) {
            EXPECT_EQ(out[k].x, out[k].y) << k;
        }
        const double s = items[k].y, rz = items[k].x, h = 1e-6 * (rz + 1e-9);
        const auto at = [&](double z) { return 1.8 * (1 - z) / (1 + s * z); };
        EXPECT_NEAR(out[k].z / ((at(rz - h) - at(rz + h)) / (2 * h)), 1, 1e-3) << k;
    }
    EXPECT_FLOAT_EQ(out.back().x, 0.8f);  // the far plane itself
    EXPECT_EQ(out.back().y, 1);           // an empty texel
}

}  // namespace
}  // namespace shadow_layers::testing
