// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/adjacency.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "base/thread_pool.h"
#include "scene/weld.h"
#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

using testing::MeshData;
using testing::to_mesh;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

MeshData lattice_soup(unsigned seed, int vertex_count, int triangle_count, int cells) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> cell(-cells, cells), vertex(0, vertex_count - 1);
    MeshData data;
    for (int i = 0; i < vertex_count; ++i) {
        glm::vec3 p(cell(random), cell(random), cell(random));
        if (i % 3 == 0) p *= -1.0f;  // makes some zeros negative
        data.positions.push_back(p);
    }
    for (int i = 0; i < triangle_count; ++i) data.triangles.push_back({vertex(random), vertex(random), vertex(random)});
    return data;
}

/// Edges by sorting strings of positions: slow and plain.
std::map<std::array<float, 6>, std::multiset<std::uint32_t>> count_edges_plainly(const Mesh& mesh) {
    std::map<std::array<float, 6>, std::multiset<std::uint32_t>> edges;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        glm::vec3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = mesh.positions[mesh.triangles[t][k]] + 0.0f;
        if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
        if (std::isnan(p[0].x + p[1].x + p[2].x)) continue;
        for (int k = 0; k < 3; ++k) {
            std::array<float, 3> a{p[k].x, p[k].y, p[k].z}, b{p[(k + 1) % 3].x, p[(k + 1) % 3].y, p[(k + 1) % 3].z};
            if (b < a) std::swap(a, b);
            edges[{a[0], a[1], a[2], b[0], b[1], b[2]}].insert(t);
        }
    }
    return edges;
}

void expect_same_edges(const Mesh& mesh, const MeshAdjacency& adjacency) {
    const auto expected = count_edges_plainly(mesh);
    ASSERT_EQ(adjacency.edge_count(), expected.size());
    for (std::uint32_t e = 0; e < adjacency.edge_count(); ++e) {
        const glm::uvec2 ends = adjacency.edge_vertices[e];
        EXPECT_LT(ends.x, ends.y);
        const glm::vec3 p = mesh.positions[ends.x] + 0.0f, q = mesh.positions[ends.y] + 0.0f;
        std::array<float, 3> a{p.x, p.y, p.z}, b{q.x, q.y, q.z};
        if (b < a) std::swap(a, b);
        std::multiset<std::uint32_t> triangles;
        for (const EdgeUse use : adjacency.uses_of(e)) {
            triangles.insert(use.triangle());
            // The winding runs from x to y unless reversed.
            bool forward = false;
            for (int k = 0; k < 3; ++k) {
                const glm::uvec3& tri = mesh.triangles[use.triangle()];
                forward = forward || (adjacency.weld[tri[k]] == ends.x && adjacency.weld[tri[(k + 1) % 3]] == ends.y);
            }
            EXPECT_EQ(forward, !use.reversed());
        }
        const auto found = expected.find({a[0], a[1], a[2], b[0], b[1], b[2]});
        ASSERT_NE(found, expected.end());
        EXPECT_EQ(triangles, found->second);
        const std::size_t kind = e < adjacency.pair_count                              ? 2
                                 : e < adjacency.pair_count + adjacency.boundary_count ? 1
                                                                                       : 3;
        EXPECT_TRUE(kind == 3 ? triangles.size() >= 3 : triangles.size() == kind);
    }
}

TEST(Adjacency, BoxOfSeparateFacesIsClosed) {
    const auto mesh = to_mesh("box", testing::make_box({1, 2, 3}));
    ASSERT_GT(mesh->positions.size(), 8u);  // each face has its own corners
    const auto adjacency = make_adjacency(*mesh);
    EXPECT_EQ(adjacency->pair_count, 18u);  // 12 edges and 6 diagonals
    EXPECT_EQ(adjacency->boundary_count, 0u);
    EXPECT_EQ(adjacency->fan_count, 0u);
    EXPECT_EQ(adjacency->component_closed, std::vector<std::uint8_t>{1});
    EXPECT_EQ(measure_components(*mesh, *adjacency).orientation, std::vector<std::int8_t>{1});
    expect_same_edges(*mesh, *adjacency);
}

TEST(Adjacency, OrientationFollowsTheWinding) {
    MeshData data = testing::make_box({1, 2, 3});
    for (glm::uvec3& tri : data.triangles) std::swap(tri.y, tri.z);
    const auto inward = to_mesh("inward", data);
    EXPECT_EQ(measure_components(*inward, *make_adjacency(*inward)).orientation, std::vector<std::int8_t>{-1});
    data.triangles.pop_back();
    const auto open = to_mesh("open", data);
    EXPECT_EQ(measure_components(*open, *make_adjacency(*open)).orientation, std::vector<std::int8_t>{0});
    data = testing::make_box({1, 2, 3});
    std::swap(data.triangles[4].y, data.triangles[4].z);
    const auto mixed = to_mesh("mixed", data);
    EXPECT_EQ(make_adjacency(*mixed)->component_closed, std::vector<std::uint8_t>{0});
}

TEST(Adjacency, PlaneHasBoundaries) {
    const auto mesh = to_mesh("plane", testing::make_plane(4, 8));
    const auto adjacency = make_adjacency(*mesh);
    EXPECT_EQ(adjacency->boundary_count, 32u);
    EXPECT_EQ(adjacency->pair_count, 8u * 8 + 2 * 8 * 7);
    EXPECT_EQ(adjacency->component_closed, std::vector<std::uint8_t>{0});
}

TEST(Adjacency, RandomSoupsMatchAPlainCount) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        const auto mesh =
            to_mesh("soup", lattice_soup(seed, 20 + 3 * int(seed), 30 + 5 * int(seed), 1 + int(seed % 3)));
        expect_same_edges(*mesh, *make_adjacency(*mesh));
    }
}

TEST(Adjacency, ThreadsDoNotChangeTheResult) {
    const auto mesh = to_mesh("soup", lattice_soup(7, 60000, 90000, 20));
    ThreadPool threads(3);
    const auto one = make_adjacency(*mesh), many = make_adjacency(*mesh, &threads);
    EXPECT_EQ(one->edge_vertices, many->edge_vertices);
    EXPECT_EQ(one->fan_first, many->fan_first);
    EXPECT_EQ(one->component, many->component);
    ASSERT_EQ(one->uses.size(), many->uses.size());
    for (std::size_t i = 0; i < one->uses.size(); ++i) ASSERT_EQ(one->uses[i].packed, many->uses[i].packed);
}

TEST(Adjacency, UnusableVerticesWeldToNothingAndDropTheirTriangles) {
    MeshData data = testing::make_plane(2, 1);
    const auto first = std::uint32_t(data.positions.size());
    data.positions.push_back({kNan, 0, 0});
    data.positions.push_back({kNan, 0, 0});
    data.triangles.push_back({0, 1, first});
    data.triangles.push_back({0, 1, first + 1});
    data.triangles.push_back({0, 1, 1});
    const auto mesh = to_mesh("holed", data);
    const auto adjacency = make_adjacency(*mesh);
    EXPECT_EQ(adjacency->weld[first + 1], first + 1);
    EXPECT_EQ(adjacency->dropped_count, 3u);
    EXPECT_FALSE(adjacency->all_usable);
    EXPECT_EQ(adjacency->pair_count, 1u);
    EXPECT_EQ(adjacency->boundary_count, 4u);
    EXPECT_FALSE(still_holds(*adjacency, *mesh));  // never assumed of such a mesh
}

TEST(Adjacency, EmptyMeshes) {
    for (const MeshData& data : {MeshData{}, MeshData{{{1, 2, 3}}, {}}}) {
        const auto adjacency = make_adjacency(*to_mesh("empty", data));
        EXPECT_EQ(adjacency->edge_count(), 0u);
        EXPECT_TRUE(adjacency->component_closed.empty());
    }
}

TEST(Weld, StillHoldsIsExact) {
    // Random small moves of whole places, of single vertices, and onto other places, against a fresh weld.
    std::mt19937 random(3);
    int kept = 0, changed = 0;
    for (int round = 0; round < 400; ++round) {
        MeshData data = lattice_soup(unsigned(round), 300, 0, 3);
        const auto weld = weld_vertices(data.positions);
        std::uniform_int_distribution<std::uint32_t> pick(0, 299);
        std::uniform_real_distribution<float> move(-0.01f, 0.01f);
        std::vector<glm::vec3> offsets(300);
        for (glm::vec3& offset : offsets) offset = {move(random), move(random), move(random)};
        for (std::uint32_t v = 0; v < 300; ++v) data.positions[v] += offsets[weld[v]];
        if (round % 4 == 1) data.positions[pick(random)].x += 0.5f;
        if (round % 4 == 2) data.positions[pick(random)] = data.positions[pick(random)];
        if (round % 4 == 3) {  // a whole place lands on another
            const std::uint32_t from = weld[pick(random)], to = weld[pick(random)];
            const glm::vec3 place = data.positions[to];
            for (std::uint32_t v = 0; v < 300; ++v)
                if (weld[v] == from) data.positions[v] = place;
        }
        const bool same = weld_vertices(data.positions) == weld;
        ASSERT_EQ(weld_still_holds(weld, data.positions), same) << "round " << round;
        ++(same ? kept : changed);
    }
    EXPECT_GT(kept, 90);
    EXPECT_GT(changed, 200);
}

}  // namespace
}  // namespace shadow_layers
