// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Revectorised percentage-closer filtering: runs of bits against one tap after the other, the techniques without a
// filter for one tap, and no seams between cube faces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

class RPCFTest : public ::testing::Test {
protected:
    /// Greatest difference between the fast evaluation and that of each tap on its own.
    double compare(const SceneView& view, const std::string& technique, ParameterValues given) {
        const auto fast = runner_.render(view, technique, given).visibility();
        given.set("early_out", false);
        const auto slow = runner_.render(view, technique, given).visibility();
        double greatest = 0;
        for (std::size_t k = 0; k < fast.size(); ++k) {
            greatest = std::max(greatest, double(std::abs(fast[k] - slow[k])));
            partly_ += slow[k] > 0 && slow[k] < 1;
        }
        return greatest;
    }
    TechniqueRunner runner_;
    std::size_t partly_ = 0;
};

SceneView random_view(unsigned seed, LightKind kind, int width = 80, int height = 45) {
    SceneView view = random_scene(seed, width, height);
    view.scene->lights = {make_light(kind, {1.2 - 0.1 * seed, 2.6, 4.6}, {0, 0, 0.4}, 70)};
    return view;
}

constexpr LightKind kKinds[] = {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area};

struct Kernel {
    std::int64_t kernel, walk_limit, spacing, map_size;
    ParameterValues values() const {
        return parameters(
            {{"kernel", kernel}, {"walk_limit", walk_limit}, {"spacing", spacing}, {"map_size", map_size}});
    }
};

// Small maps have many corners, channels and short runs in a kernel, long walks few.
constexpr Kernel kKernels[] = {{2, 3, 1, 40}, {7, 16, 1, 100}, {10, 5, 1, 64}, {4, 16, 3, 128}};

TEST_F(RPCFTest, RunsOfHardBordersEqualSingleTaps) {
    unsigned seed = 1;
    for (const Kernel& kernel : kKernels)
        for (int turn = 0; turn < 2; ++turn) {
            ++seed;
            EXPECT_EQ(compare(random_view(seed, kKinds[seed % 4]), "rpcf_smsr", kernel.values()), 0) << seed;
        }
    EXPECT_GT(partly_, 3000u);
}

TEST_F(RPCFTest, RunsOfSmoothBordersEqualSingleTaps) {
    unsigned seed = 1;
    for (const Kernel& kernel : kKernels) {
        ParameterValues given = kernel.values();
        given.set("channels", std::string(++seed % 2 ? "paper" : "disjoint"));
        EXPECT_LE(compare(random_view(seed, kKinds[seed % 4]), "rpcf_rsmss", given), 1e-5) << seed;
    }
    EXPECT_GT(partly_, 1000u);
}

TEST_F(RPCFTest, WideKernelsAreCutIntoTiles) {
    // 16 taps three texels apart: four tiles, of which the last are not full.
    const auto given = Kernel{16, 4, 3, 200}.values();
    EXPECT_EQ(compare(random_view(3, LightKind::Spot, 48, 27), "rpcf_smsr", given), 0);
    EXPECT_LE(compare(random_view(3, LightKind::Spot, 48, 27), "rpcf_rsmss", given), 1e-5);
}

TEST_F(RPCFTest, OneTapIsTheTechniqueWithoutAFilter) {
    for (const LightKind kind : kKinds)
        for (const auto& [filtered, plain] : {std::pair{"rpcf_smsr", "smsr"}, {"rpcf_rsmss", "rsmss"}}) {
            const SceneView view = random_view(5, kind, 160, 90);
            const ParameterValues map = parameters({{"map_size", std::int64_t{256}}});
            ParameterValues one = map;
            one.set("kernel", std::int64_t{1});
            const auto expected = runner_.render(view, plain, map).visibility();
            const auto found = runner_.render(view, filtered, one).visibility();
            // Borders of the maps differ in width, and so may the fit of the views.
            double difference = 0;
            for (std::size_t k = 0; k < found.size(); ++k) difference += std::abs(found[k] - expected[k]);
            EXPECT_LE(difference / double(found.size()), 0.004) << filtered;
        }
}

TEST_F(RPCFTest, NoSeamsAtCubeFaces) {
    // Point light in the middle of an empty room: nothing is in shadow, whatever kernels and walks reach over.
    SceneView view;
    view.width = 160, view.height = 90;
    const auto wall = view.add("wall", make_plane(4, 3));
    view.place(wall, placement({0, 0, -2}));
    view.place(wall, placement({0, 0, 2}, 180, {1, 0, 0}));
    view.place(wall, placement({-2, 0, 0}, 90, {0, 1, 0}));
    view.place(wall, placement({2, 0, 0}, -90, {0, 1, 0}));
    view.place(wall, placement({0, 2, 0}, 90, {1, 0, 0}));
    view.place(wall, placement({0, -2, 0}, -90, {1, 0, 0}));
    view.camera = make_camera({-1.7, -1.6, 1.2}, {1, 1.2, -0.4}, view.width, view.height, 100);
    view.scene->lights = {make_light(LightKind::Point, {0.11, 0.07, 0.13}, {1, 0.4, 0.2})};
    for (const char* technique : {"rpcf_smsr", "rpcf_rsmss"})
        for (const std::int64_t kernel : {3, 10}) {
            const auto run = runner_.render(view, technique, Kernel{kernel, 16, 1, 64}.values());
            ASSERT_GE(run.positions[0].views.size(), 4u);
            // Taps past a room's edge meet the wall behind it; the seams lie across the flat walls.
            int dark_on_flat = 0;
            for (std::size_t pixel = 0; pixel < run.visibility().size(); ++pixel) {
                const glm::dvec3 at = glm::abs(glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws);
                const double second = std::max({std::min(at.x, at.y), std::min(at.y, at.z), std::min(at.x, at.z)});
                const double reach = 2.5 * double(kernel + 3) * 2.0 * 2.2 / 64;
                if (second < 2.0 - reach) dark_on_flat += run.visibility()[pixel] < 1;
            }
            EXPECT_EQ(dark_on_flat, 0) << technique << ", " << kernel;
        }
}

TEST_F(RPCFTest, ABorderOverCubeFacesHasNoGap) {
    // A long bar's shadow crosses the seam between two faces of a point light's cube, next to its middle line.
    SceneView view;
    view.width = 160, view.height = 90;
    view.place(view.add("ground", make_plane(20)));
    view.place(view.add("bar", make_plane(8)), placement({0, 4.31, 1}), kInstanceShadow);
    view.camera = make_camera({0, 0.4, 14}, {0, 0.4, 0}, view.width, view.height, 50);
    view.scene->lights = {make_light(LightKind::Point, {0, 0, 2}, {1, 1, 2})};
    const auto given = Kernel{7, 16, 1, 128}.values();
    for (const char* technique : {"rpcf_smsr", "rpcf_rsmss"}) {
        const auto run = runner_.render(view, technique, given);
        ASSERT_GE(run.positions[0].views.size(), 3u);
        // Along each column that the edge crosses, light falls off once, without a second border.
        for (int x = 40; x < 120; ++x) {
            float before = 1;
            for (int y = 0; y < 60; ++y) {
                const float v = run.visibility()[std::size_t(y * view.width + x)];
                EXPECT_LE(v, before + 0.05f) << technique << " at " << x << ", " << y;
                before = v;
            }
        }
    }
}

}  // namespace
}  // namespace shadow_layers::testing
