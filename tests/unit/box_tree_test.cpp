// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "base/thread_pool.h"
#include "support/technique_scenes.h"

namespace shadow_layers::testing {
namespace {

MeshData make_soup(unsigned seed, int count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-10, 10), size(-0.5, 0.5);
    MeshData data;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 at(place(random), place(random), place(random));
        for (int k = 0; k < 3; ++k) data.positions.push_back(at + glm::vec3(size(random), size(random), size(random)));
        data.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return data;
}

/// Walks the tree: every corner must lie in all boxes above it. Returns the items found, each once.
std::multiset<std::uint32_t> collect_items(const BoxTree& tree, const Mesh& mesh) {
    std::multiset<std::uint32_t> found;
    const auto check = [&](std::uint32_t item, const BoxTree::Node& node, std::size_t lane) {
        for (int corner = 0; corner < 3; ++corner)
            for (int k = 0; k < 3; ++k) {
                const float at = mesh.positions[mesh.triangles[item][corner]][k];
                EXPECT_TRUE(at >= node.low[k][lane] && at <= node.high[k][lane]) << "item " << item;
            }
    };
    const auto walk = [&](const auto& self, std::uint32_t number) -> std::vector<std::uint32_t> {
        std::vector<std::uint32_t> all;
        const BoxTree::Node& node = tree.nodes[number];
        for (std::size_t lane = 0; lane < kTreeWidth; ++lane) {
            const std::uint32_t child = node.child[lane];
            if (child == BoxTree::kNoChild) continue;
            std::vector<std::uint32_t> below;
            if (child & BoxTree::kLeaf) {
                const std::uint32_t leaf = child & ~BoxTree::kLeaf;
                EXPECT_LE(tree.leaf_first[leaf + 1] - tree.leaf_first[leaf], kTreeWidth);
                for (std::uint32_t i = tree.leaf_first[leaf]; i < tree.leaf_first[leaf + 1]; ++i)
                    below.push_back(tree.items[i]);
            } else {
                EXPECT_GT(child, number) << "children come after their parents";
                below = self(self, child);
            }
            for (const std::uint32_t item : below) check(item, node, lane);
            all.insert(all.end(), below.begin(), below.end());
        }
        return all;
    };
    if (!tree.nodes.empty())
        for (const std::uint32_t item : walk(walk, 0)) found.insert(item);
    return found;
}

TEST(BoxTree, HoldsEveryTriangleOnceInsideOfItsBoxes) {
    for (const int count : {1, 7, 8, 9, 100, 5000}) {
        const auto mesh = to_mesh("soup", make_soup(unsigned(count), count));
        const auto tree = make_mesh_tree(*mesh);
        const auto found = collect_items(*tree, *mesh);
        EXPECT_EQ(found.size(), std::size_t(count));
        EXPECT_EQ(std::set<std::uint32_t>(found.begin(), found.end()).size(), std::size_t(count));
    }
}

TEST(BoxTree, LeavesOutWhatCannotBeUsed) {
    MeshData data = make_soup(1, 50);
    data.positions[4].x = std::numeric_limits<float>::quiet_NaN();
    data.positions[31].y = std::numeric_limits<float>::infinity();
    const auto mesh = to_mesh("soup", std::move(data));
    const auto found = collect_items(*make_mesh_tree(*mesh), *mesh);
    EXPECT_EQ(found.size(), 48u);
    EXPECT_EQ(found.count(1) + found.count(10), 0u);
    MeshData none = make_soup(2, 1);
    none.positions[0].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(make_mesh_tree(*to_mesh("none", std::move(none)))->nodes.empty());
}

TEST(BoxTree, IsTheSameWhateverTheThreads) {
    const auto mesh = to_mesh("soup", make_soup(3, 20000));
    ThreadPool threads(4);
    const auto one = make_mesh_tree(*mesh), four = make_mesh_tree(*mesh, &threads);
    EXPECT_EQ(one->items, four->items);
    EXPECT_EQ(one->leaf_first, four->leaf_first);
    EXPECT_EQ(one->nodes.size(), four->nodes.size());
}

TEST(BoxTree, EqualTrianglesMakeAShallowTree) {
    MeshData data;
    data.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    data.triangles.assign(10000, {0, 1, 2});
    const auto mesh = to_mesh("same", std::move(data));
    const auto tree = make_mesh_tree(*mesh);
    EXPECT_EQ(collect_items(*tree, *mesh).size(), 10000u);
    EXPECT_LT(tree->nodes.size(), 3000u);
}

TEST(BoxTree, IsFittedToMovedPositions) {
    const MeshData data = make_soup(5, 3000);
    const auto mesh = to_mesh("soup", data);
    const auto tree = make_mesh_tree(*mesh);
    MeshData moved = data;
    for (glm::vec3& p : moved.positions) p = 2.0f * p + glm::vec3(0.1f * p.y, 3, -1);
    const auto moved_mesh = to_mesh("soup", std::move(moved));
    const auto fitted = refit_mesh_tree(*tree, *moved_mesh);
    ASSERT_TRUE(fitted);
    EXPECT_EQ(collect_items(*fitted, *moved_mesh).size(), 3000u);
    // Shuffled triangles no longer lie together: the tree is given up.
    MeshData shuffled = make_soup(6, 3000);
    EXPECT_FALSE(refit_mesh_tree(*tree, *to_mesh("soup", std::move(shuffled))));
    // So it is when a vertex can't be used any more.
    MeshData broken = data;
    broken.positions[17].z = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(refit_mesh_tree(*tree, *to_mesh("soup", std::move(broken))));
}

}  // namespace
}  // namespace shadow_layers::testing
