// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mesh_data_cache.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

using testing::MeshData;
using testing::to_mesh;

constexpr std::size_t kBudget = std::size_t{64} << 20;

MeshData bend(MeshData data, int frame) {
    for (glm::vec3& p : data.positions) p.x += 0.1f * std::sin(p.z + 0.1f * float(frame));
    return data;
}

/// What was made from which mesh, and from what else.
struct Tree {
    std::string name, refitted_from;
    std::size_t bytes = 10;
    std::size_t byte_size() const { return bytes; }
};

std::shared_ptr<const Tree> get_tree(MeshDataCache& cache, const Mesh& mesh, std::size_t bytes = 10) {
    return cache.get_for_mesh<Tree>(mesh, [&](const std::shared_ptr<const Tree>& other) {
        return std::make_shared<const Tree>(Tree{mesh.name, other ? other->name : "", bytes});
    });
}

TEST(MeshDataCache, StartsFromTheSameTopologyAtOtherPositions) {
    MeshDataCache cache(kBudget);
    const MeshData ball = testing::make_sphere(1);
    const auto still = to_mesh("still", ball), bent = to_mesh("bent", bend(ball, 1)),
               more = to_mesh("more", bend(ball, 2));
    const auto plane = to_mesh("plane", testing::make_plane(4, 4));
    const auto first = get_tree(cache, *still);
    EXPECT_EQ(first->refitted_from, "");
    EXPECT_EQ(get_tree(cache, *plane)->refitted_from, "");
    EXPECT_EQ(get_tree(cache, *bent)->refitted_from, "still");
    EXPECT_EQ(get_tree(cache, *more)->refitted_from, "bent");
    EXPECT_EQ(get_tree(cache, *still), first);
    EXPECT_EQ(cache.bytes(), 40u);
}

TEST(MeshDataCache, UsesWhatIsOverTheBudgetAndDoesNotKeepIt) {
    MeshDataCache cache(100);
    const auto mesh = to_mesh("m", testing::make_sphere(1));
    const auto tree = get_tree(cache, *mesh, 101);
    ASSERT_NE(tree, nullptr);
    EXPECT_EQ(cache.bytes(), 0u);
    EXPECT_NE(get_tree(cache, *mesh, 101), tree);
    EXPECT_GT(cache.get_edges(*mesh).adjacency->edge_count(), 0u);
    EXPECT_LE(cache.bytes(), 100u);
}

TEST(MeshDataCache, KeepsWhatHangsOnTopologyAlone) {
    MeshDataCache cache(kBudget);
    const MeshData ball = testing::make_sphere(1);
    int made = 0;
    const auto get = [&](const MeshData& data) {
        return cache.get_for_topology<Tree>(*to_mesh("m", data), [&] {
            ++made;
            return std::make_shared<const Tree>();
        });
    };
    EXPECT_EQ(get(ball), get(bend(ball, 1)));
    get(testing::make_plane(4, 4));
    EXPECT_EQ(made, 2);
}

TEST(MeshDataCache, WeldsADeformingMeshOnce) {
    MeshDataCache cache(kBudget);
    const MeshData data = testing::make_sphere(1);
    const auto first = cache.get_edges(*to_mesh("frame 0", data));
    std::size_t bytes = 0;
    for (int frame = 1; frame < 60; ++frame) {
        cache.begin_render();
        const auto bent = to_mesh("frame", bend(data, frame));
        const auto edges = cache.get_edges(*bent);
        EXPECT_EQ(edges.adjacency, first.adjacency);
        EXPECT_EQ(cache.get_edges(*bent).shapes, edges.shapes);
        if (frame == 10) bytes = cache.bytes();
    }
    EXPECT_EQ(cache.bytes(), bytes);  // frames that went by are forgotten
}

TEST(MeshDataCache, WeldsAgainWhenPlacesComeTogetherOrPart) {
    MeshDataCache cache(kBudget);
    MeshData open = testing::make_plane(2, 2), shut = open;
    shut.positions[0] = shut.positions[1];
    const auto opened = cache.get_edges(*to_mesh("open", open)), closed = cache.get_edges(*to_mesh("shut", shut));
    EXPECT_NE(opened.adjacency, closed.adjacency);
    EXPECT_EQ(opened.adjacency->dropped_count, 0u);
    EXPECT_EQ(closed.adjacency->dropped_count, 1u);
    for (int round = 0; round < 3; ++round) {  // both are kept, also for other positions
        EXPECT_EQ(cache.get_edges(*to_mesh("open", bend(open, round))).adjacency, opened.adjacency);
        EXPECT_EQ(cache.get_edges(*to_mesh("shut", bend(shut, round))).adjacency, closed.adjacency);
    }
}

TEST(MeshDataCache, ForgetsWhatTheLastRendersDidNotUse) {
    MeshDataCache cache(kBudget);
    const auto still = to_mesh("still", testing::make_sphere(1));
    const auto adjacency = cache.get_edges(*still).adjacency;
    MeshDataCache alone(kBudget);
    alone.get_edges(*still);
    for (int render = 1; render <= 40; ++render) {
        cache.begin_render();
        EXPECT_EQ(cache.get_edges(*still).adjacency, adjacency);
        cache.get_edges(*to_mesh("new topology", testing::make_plane(4, 4 + render)));
        get_tree(cache, *to_mesh("new topology", testing::make_plane(4, 4 + render)));
    }
    EXPECT_GT(cache.bytes(), alone.bytes());
    for (std::uint64_t render = 0; render <= kKeptRenders; ++render) {
        cache.begin_render();
        cache.get_edges(*still);
    }
    EXPECT_EQ(cache.bytes(), alone.bytes());
}

TEST(MeshDataCache, StaysWithinItsBudget) {
    MeshDataCache cache(1 << 20);
    for (int i = 0; i < 50; ++i) {
        const auto mesh = to_mesh("m", testing::make_sphere(1, 10 + i, 20 + i));
        EXPECT_GT(cache.get_edges(*mesh).adjacency->edge_count(), 0u);
        EXPECT_LE(cache.bytes(), std::size_t{1} << 20);
    }
    cache.clear();
    EXPECT_EQ(cache.bytes(), 0u);
}

TEST(MeshDataCache, HoldsNoAdjacencyThatItDoesNotCount) {
    const auto mesh = to_mesh("m", testing::make_sphere(1));
    MeshDataCache whole(kBudget);
    whole.get_edges(*mesh);
    // Room for all but a few bytes of it: shapes and adjacency come and go, and none outlives its entry.
    MeshDataCache cache(whole.bytes() - 1);
    for (int round = 0; round < 4; ++round) {
        std::weak_ptr<const MeshAdjacency> adjacency = cache.get_edges(*mesh).adjacency;
        if (!adjacency.expired()) EXPECT_GE(cache.bytes(), adjacency.lock()->byte_size());
    }
}

}  // namespace
}  // namespace shadow_layers
