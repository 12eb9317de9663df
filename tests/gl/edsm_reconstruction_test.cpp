// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/lib/edge_reconstruction_lib.glsl: borders that are known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/glsl_lib_runner.h"

namespace shadow_layers::testing {
namespace {

struct Footprint {
    glm::vec2 at;
    glm::vec4 lit;
    glm::vec4 texels[4];  ///< normal, distance, relevant
};

struct Answer {
    bool by_line;
    double line, forced;
};

class EdgeReconstruction : public ::testing::Test {
protected:
    std::vector<Answer> run(const std::vector<Footprint>& footprints) {
        std::vector<glm::vec4> items;
        for (const Footprint& f : footprints) {
            items.push_back(glm::vec4(f.at, 0, 0)), items.push_back(f.lit);
            for (const glm::vec4& t : f.texels) items.push_back(t);
        }
        const auto out =
            runner_.run("lib/edge_reconstruction_lib.glsl",
                        "vec2 at = inputs[6*i].xy; vec4 lit = inputs[6*i+1], signs = 2.0 * lit - 1.0;\n"
                        "vec4 weights = bilinear_weights(at);\n"
                        "BorderEstimate e = kNoEstimate;\n"
                        "for (int k = 0; k < 4; ++k) { vec4 s = inputs[6*i+2+k];\n"
                        "  add_texel(e, EdgeTexel(s.xy, s.z, s.w > 0.5), kCorners[k], weights[k], signs[k], signs,\n"
                        "            at, 0.5); }\n"
                        "outputs[i] = vec4(float(e.line_weight > 0.0), e.by_line, e.forced, 0.0);",
                        items, int(footprints.size()), 1);
        std::vector<Answer> answers;
        for (const glm::vec4& o : out) answers.push_back({o.x > 0.5f, o.y, o.z});
        return answers;
    }
    GlslLibRunner runner_;
};

glm::vec2 corner(int k) { return {k & 1, k >> 1}; }

/// A straight border through the footprint, lit where dot(n, p) > c; texel k holds it if `held` says so.
Footprint straight(glm::vec2 normal, float c, glm::vec2 at, unsigned held, bool flip = false) {
    Footprint f{at, {}, {}};
    for (int k = 0; k < 4; ++k) {
        const float d = glm::dot(normal, corner(k)) - c;
        f.lit[k] = d > 0 ? 1.0f : 0.0f;
        f.texels[k] = glm::vec4(flip ? -normal : normal, flip ? -d : d, (held >> k) & 1u ? 1.0f : 0.0f);
    }
    return f;
}

TEST_F(EdgeReconstruction, StraightBordersAreExactInAllDirections) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Footprint> footprints;
    std::vector<double> truths;
    for (int k = 0; k < 20000; ++k) {
        const float angle = 6.2831853f * unit(random);
        const glm::vec2 normal(std::cos(angle), std::sin(angle));
        const glm::vec2 through(unit(random), unit(random)), at(unit(random), unit(random));
        const float c = glm::dot(normal, through);
        footprints.push_back(straight(normal, c, at, 1u + unsigned(unit(random) * 15) % 15u));
        truths.push_back(glm::dot(normal, at) - c);
    }
    const auto answers = run(footprints);
    int mixed = 0, full = 0;
    for (std::size_t k = 0; k < answers.size(); ++k) {
        const glm::vec4 lit = footprints[k].lit;
        if (lit == glm::vec4(lit.x)) continue;
        ++mixed;
        ASSERT_TRUE(answers[k].by_line) << k;
        ASSERT_NEAR(answers[k].line, truths[k], 2e-6) << k;
        bool all_held = true;
        for (const glm::vec4& t : footprints[k].texels) all_held &= t.w > 0.5f;
        if (!all_held) continue;
        ++full;
        ASSERT_NEAR(answers[k].forced, truths[k], 2e-6)
            << k;  // [Kenzel13] 3.1.1: a line survives bilinear interpolation
    }
    EXPECT_GT(mixed, 10000);
    EXPECT_GT(full, 300);
}

TEST_F(EdgeReconstruction, WithoutEdgesTheBorderLiesMidway) {
    std::vector<Footprint> footprints;
    for (int k = 0; k < 11; ++k) {
        Footprint f{{float(k) / 10.0f, 0.3f}, {1, 0, 1, 0}, {}};
        footprints.push_back(f);
    }
    const auto answers = run(footprints);
    for (std::size_t k = 0; k < answers.size(); ++k) {
        EXPECT_FALSE(answers[k].by_line);
        EXPECT_NEAR(answers[k].forced, 0.5 - double(k) / 10.0, 1e-6);
    }
}

TEST_F(EdgeReconstruction, ALineThatContradictsATestIsNotBelieved) {
    // The line x = 0.25 says that corner 1 is not lit, yet its test says it is.
    Footprint f = straight({-1, 0}, -0.25f, {0.5f, 0.5f}, 15);
    f.lit = {1, 1, 1, 0};
    // Nor one whose caster would be on the lit side.
    const Footprint flipped = straight({-1, 0}, -0.25f, {0.5f, 0.5f}, 15, true);
    for (const Answer& answer : run({f, flipped})) EXPECT_FALSE(answer.by_line);
}

TEST_F(EdgeReconstruction, DiscKernelIsTheLitPartOfADisc) {
    std::vector<glm::vec4> items;
    for (int k = 0; k <= 200; ++k) items.push_back(glm::vec4(float(k - 100) / 40.0f, 3.0f, 0, 0));
    const auto out =
        runner_.run("lib/edge_reconstruction_lib.glsl", "outputs[i] = vec4(disc_kernel(inputs[i].x, inputs[i].y));",
                    items, int(items.size()), 1);
    for (std::size_t k = 0; k < items.size(); ++k) {
        // Numeric area of the unit disc on the lit side of x = -d.
        const double d = std::clamp(2.0 * double(items[k].x) / 3.0, -1.0, 1.0);
        double area = 0;
        const int steps = 4000;
        for (int s = 0; s < steps; ++s) {
            const double x = -1 + 2 * (s + 0.5) / steps;
            if (x < d) area += 2 * std::sqrt(1 - x * x) * 2 / steps;
        }
        EXPECT_NEAR(out[k].x, area / std::acos(-1.0), 1e-3);
    }
}

}  // namespace
}  // namespace shadow_layers::testing
