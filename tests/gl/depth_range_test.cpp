// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The depth range map against brute force over the depth map, and what its windows decide against every single test.
#include "depth_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "stages/depth_range_map.h"
#include "support/glsl_lib_runner.h"
#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

constexpr float kMixed = -1;  // kWindowMixed of the library

struct Ranges {
    float low = 2, high = -2;
    void add(float value) { low = std::min(low, value), high = std::max(high, value); }
};

TEST(DepthRangeMapTest, HoldsTheRangesOfDepthsAndStepsWithinReach) {
    TechniqueRunner runner;
    for (const int size : {1, 3, 37, 64}) {
        SceneView view = random_scene(3, 64, 36);
        view.scene->lights = {make_light(LightKind::Point, {0.4, 0.3, 2.2}, {0, 0, 0})};
        const auto run = runner.render(view, "sm", parameters({{"map_size", std::int64_t(size)}}));
        Engine& engine = runner.engine();
        const auto map = render_depth_map(engine, *view.scene, run.positions[0]);
        const int side = map->texture->width(), layers = map->texture->layers();
        const auto depths = map->texture->download<float>();
        const auto depth_at = [&](int x, int y, int layer) {
            x = std::clamp(x, 0, side - 1), y = std::clamp(y, 0, side - 1);
            return depths[std::size_t((layer * side + y) * side + x)];
        };
        const int reach = 5, radius_blocks = 2;
        const auto ranges = render_depth_range_map(engine, *map, reach);
        const auto found = ranges->range_tx->download<glm::vec4>(),
                   found_steps = ranges->steps_tx->download<glm::vec4>();
        const int blocks = ranges->range_tx->width();
        ASSERT_EQ(blocks, (side + kRangeBlockTexels - 1) / kRangeBlockTexels);
        for (int layer = 0; layer < layers; ++layer)
            for (int y = 0; y < blocks; ++y)
                for (int x = 0; x < blocks; ++x) {
                    Ranges range, steps_x, steps_y;
                    const auto first = [&](int block) {
                        return std::max(0, block - radius_blocks) * kRangeBlockTexels;
                    };
                    const auto end = [&](int block) {
                        return std::min(blocks, block + radius_blocks + 1) * kRangeBlockTexels;
                    };
                    for (int v = first(y); v < end(y); ++v)
                        for (int u = first(x); u < end(x); ++u) {
                            range.add(depth_at(u, v, layer));
                            steps_x.add(depth_at(u + 1, v, layer) - depth_at(u, v, layer));
                            steps_y.add(depth_at(u, v + 1, layer) - depth_at(u, v, layer));
                        }
                    const std::size_t at = std::size_t((layer * blocks + y) * blocks + x);
                    const glm::vec3 expected(range.low, range.high,
                                             depth_at(x * kRangeBlockTexels, y * kRangeBlockTexels, layer));
                    ASSERT_EQ(glm::vec3(found[at]), expected) << size << ": " << x << ", " << y << ", " << layer;
                    ASSERT_EQ(found_steps[at], glm::vec4(steps_x.low, steps_x.high, steps_y.low, steps_y.high));
                }
    }
}

/// Windows of 7 x 7 texels over planes, steps and noise, with receivers on, before and behind them. `inputs`: 4 vectors
/// for the receiver and the window, then the window's texels, four per vector.
struct Windows {
    std::vector<glm::vec4> inputs;
    int count = 0;
    static constexpr int kSide = 7, kVectors = 5 + (kSide * kSide + 3) / 4;

    void add(std::mt19937& random, bool on_plane) {
        std::uniform_real_distribution<float> unit(-1, 1);
        const glm::vec2 gradient = glm::vec2(unit(random), unit(random)) * 3e-3f;
        const float depth = 0.5f + 0.1f * unit(random),
                    push = 0.5f * std::max(std::abs(gradient.x), std::abs(gradient.y));
        const glm::vec2 place(3.5f + 0.5f * unit(random), 3.5f + 0.5f * unit(random));
        const float noise = on_plane ? 0.0f : std::pow(10.0f, -2.5f + 2.0f * unit(random)),
                    raise = on_plane ? 0.0f : 4 * noise * unit(random);
        std::vector<float> texels;
        for (int k = 0; k < kSide * kSide; ++k) {
            const glm::vec2 offset = glm::vec2(k % kSide + 0.5f, k / kSide + 0.5f) - place;
            texels.push_back(depth - push + glm::dot(gradient, offset) + raise + noise * unit(random));
        }
        Ranges range, steps_x, steps_y;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const auto at = [&](int u, int v) { return texels[std::size_t(v * kSide + u)]; };
                range.add(at(x, y));
                if (x + 1 < kSide) steps_x.add(at(x + 1, y) - at(x, y));
                if (y + 1 < kSide) steps_y.add(at(x, y + 1) - at(x, y));
            }
        inputs.push_back({place, depth, 1e-6f});
        inputs.push_back({gradient, range.low, range.high});
        inputs.push_back({steps_x.low, steps_x.high, steps_y.low, steps_y.high});
        const auto base = glm::ivec2(random() % kSide, random() % kSide);
        inputs.push_back({base, texels[std::size_t(base.y * kSide + base.x)], 0});
        inputs.push_back({});
        texels.resize(4 * (kVectors - 5));
        for (std::size_t k = 0; k < texels.size(); k += 4)
            inputs.push_back({texels[k], texels[k + 1], texels[k + 2], texels[k + 3]});
        ++count;
    }
};

TEST(DepthRangeLibTest, WhatAWindowDecidesHoldsForEachOfItsTests) {
    Windows windows;
    std::mt19937 random(5);
    const int planes = 500;
    for (int k = 0; k < 8000; ++k) windows.add(random, k < planes);
    const std::string body = R"(
    const int side = 7, stride = 5 + 13;
    vec4 a = inputs[i * stride], b = inputs[i * stride + 1], d = inputs[i * stride + 3];
    MapPoint point = MapPoint(a.xy, a.z, b.xy, a.w);
    DepthWindow window = DepthWindow(b.z, b.w, d.z, inputs[i * stride + 2], d.xy, vec2(0), vec2(side - 1), true);
    float lit = 0.0;
    for (int k = 0; k < side * side; ++k) {
        float reference = reference_depth(point, vec2(k % side, k / side) + 0.5 - point.texel);
        lit += reference >= inputs[i * stride + 5 + k / 4][k % 4] ? 1.0 : 0.0;
    }
    outputs[i] = vec4(decide_window(point, window), lit / float(side * side), 0, 0);)";
    const auto results = GlslLibRunner().run("lib/depth_range_lib.glsl", body, windows.inputs, windows.count, 1);
    int decided_lit = 0, decided_dark = 0, mixed = 0;
    for (int k = 0; k < windows.count; ++k) {
        const glm::vec4 result = results[std::size_t(k)];
        ASSERT_TRUE(result.x == kMixed || result.x == result.y) << k;
        ASSERT_TRUE(k >= planes || result.x == 1.0f) << "a lit slope is decided, " << k;
        decided_lit += result.x == 1.0f, decided_dark += result.x == 0.0f;
        mixed += result.x == kMixed && result.y > 0 && result.y < 1;
    }
    EXPECT_GT(decided_lit, planes + 100);
    EXPECT_GT(decided_dark, 100);
    EXPECT_GT(mixed, 100);
}

}  // namespace
}  // namespace shadow_layers::testing
