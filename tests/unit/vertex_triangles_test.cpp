// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/vertex_triangles.h"

#include <gtest/gtest.h>

#include <random>

#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

TEST(VertexTriangles, ListEachTriangleAtEachOfItsVertices) {
    std::mt19937 random(3);
    std::uniform_int_distribution<std::uint32_t> vertex(0, 39);
    testing::MeshData data;
    data.positions.resize(45);  // the last five are used by no triangle
    for (int i = 0; i < 100; ++i) data.triangles.push_back({vertex(random), vertex(random), vertex(random)});
    data.triangles.push_back({7, 7, 9});
    const auto mesh = testing::to_mesh("soup", data);
    const auto found = make_vertex_triangles(*mesh);
    for (std::uint32_t v = 0; v < 45; ++v) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t t = 0; t < data.triangles.size(); ++t)
            for (int k = 0; k < 3; ++k)
                if (data.triangles[t][k] == v) expected.push_back(t);
        const auto of = found->of(v);
        EXPECT_EQ(std::vector<std::uint32_t>(of.begin(), of.end()), expected) << v;
    }
    EXPECT_GE(found->byte_size(), 4 * (46 + 3 * 101u));
}

TEST(VertexTriangles, AreEmptyForAnEmptyMesh) {
    EXPECT_TRUE(make_vertex_triangles(*testing::to_mesh("nothing", {}))->triangles.empty());
}

}  // namespace
}  // namespace shadow_layers
