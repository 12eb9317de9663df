// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/silhouettes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/thread_pool.h"
#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

using testing::MeshData;
using testing::to_mesh;

MeshEdges edges_of(const Mesh& mesh) {
    MeshEdges edges;
    edges.adjacency = make_adjacency(mesh);
    edges.shapes = std::make_shared<const ComponentShapes>(measure_components(mesh, *edges.adjacency));
    return edges;
}

/// Vertices on a small lattice, so that many coincide; any winding; zero-area and duplicate triangles among them.
MeshData random_soup(unsigned seed) {
    std::mt19937 random(seed);
    const int vertex_count = 6 + int(seed % 20), triangle_count = 2 + int(seed % 40);
    std::uniform_int_distribution<int> cell(-2, 2), vertex(0, vertex_count - 1);
    MeshData data;
    for (int i = 0; i < vertex_count; ++i)
        data.positions.push_back(glm::vec3(cell(random), cell(random), cell(random)) * 0.37f);
    for (int i = 0; i < triangle_count; ++i) data.triangles.push_back({vertex(random), vertex(random), vertex(random)});
    if (seed % 3 == 0) data.triangles.push_back(data.triangles.front());
    return data;
}

/// Sheared, unevenly scaled, every other one mirrored; far from the origin.
glm::dmat4 random_placement(unsigned seed) {
    std::mt19937 random(seed + 1000);
    std::uniform_real_distribution<double> value(-1, 1);
    glm::dmat4 matrix(1);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) matrix[i][j] = value(random) * (i + 1);
    matrix[3] = glm::dvec4(30 * value(random), 30 * value(random), 30 * value(random), 1);
    return matrix;
}

/// Counts what lines from a light meet, and how often the way between two lines crosses silhouettes. For a point light
/// lines are directions; for a sun they are the points through which they pass.
class LineCounter {
public:
    LineCounter(const Mesh& mesh, const glm::dmat4& matrix, const LightPoint& light) : mesh_(mesh), light_(light) {
        for (const glm::vec3& p : mesh.positions) {
            const glm::dvec3 world(matrix * glm::dvec4(p, 1));
            corners_.push_back(light.w == 0 ? world : world - glm::dvec3(light));
        }
    }
    /// Side of the line `at` from edge p-q: > 0 on the side that a triangle p, q, r turned to the light covers.
    double side(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& at) const {
        if (light_.w == 0) return glm::dot(glm::cross(q - p, at - p), glm::dvec3(light_));
        return -glm::dot(glm::cross(p, q), at);
    }
    int count_triangles(const glm::dvec3& at) const {
        int count = 0;
        for (const glm::uvec3& tri : mesh_.triangles) {
            const glm::dvec3 &a = corners_[tri.x], &b = corners_[tri.y], &c = corners_[tri.z];
            const double u = side(a, b, at), v = side(b, c, at), w = side(c, a, at);
            const bool all_in = u > 0 && v > 0 && w > 0, all_out = u < 0 && v < 0 && w < 0;
            if (!all_in && !all_out) continue;
            // A line has a start at a point light: only what lies ahead counts.
            if (light_.w != 0) {
                const glm::dvec3 normal = glm::cross(b - a, c - a);
                if (!(glm::dot(a, normal) / glm::dot(at, normal) > 0)) continue;
            }
            ++count;
        }
        return count;
    }
    /// +1 if the way from one line to the other enters the covered side of a-b, -1 if it leaves it.
    int cross(std::uint32_t a, std::uint32_t b, const glm::dvec3& from, const glm::dvec3& to) const {
        const glm::dvec3 &p = corners_[a], &q = corners_[b];
        const double start = side(p, q, from), end = side(p, q, to), at_p = side(from, to, p), at_q = side(from, to, q);
        if (light_.w == 0) return start * end < 0 && at_p * at_q < 0 ? (end > 0 ? 1 : -1) : 0;
        if (start < 0 && end > 0 && at_p > 0 && at_q < 0) return 1;
        if (start > 0 && end < 0 && at_p < 0 && at_q > 0) return -1;
        return 0;
    }
    const glm::dvec3& corner(std::uint32_t v) const { return corners_[v]; }

private:
    const Mesh& mesh_;
    LightPoint light_;
    std::vector<glm::dvec3> corners_;
};

// algorithms: the signed edge multiplicities of arbitrary meshes. The number of triangles on a line changes exactly by
// the multiplicities of the silhouette edges on the way.
TEST(Silhouettes, CrossingsCountTrianglesOfRandomSoups) {
    int checked = 0, covered = 0;
    for (unsigned seed = 0; seed < 300; ++seed) {
        const auto mesh = to_mesh("soup", random_soup(seed));
        const glm::dmat4 matrix = random_placement(seed);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> value(-1, 1);
        const auto any = [&] { return glm::dvec3(value(random), value(random), value(random)); };
        const glm::dvec3 middle(matrix[3]);
        const LightPoint light = seed % 2 ? LightPoint(glm::normalize(any()), 0) : LightPoint(middle + 3.0 * any(), 1);
        const auto found = find_silhouettes(*mesh, edges_of(*mesh), matrix, light);
        const LineCounter lines(*mesh, matrix, light);
        for (int i = 0; i < 20; ++i) {
            const auto line = [&] { return light.w == 0 ? middle + any() : middle + any() - glm::dvec3(light); };
            const glm::dvec3 from = line(), to = line();
            int change = 0;
            for (const SilhouetteEdge& edge : found) {
                ASSERT_GT(edge.multiplicity, 0);
                change += edge.multiplicity * lines.cross(edge.a, edge.b, from, to);
            }
            const int before = lines.count_triangles(from), after = lines.count_triangles(to);
            ASSERT_EQ(after - before, change) << "seed " << seed << ", pair " << i;
            ++checked;
            covered += after != before;
        }
    }
    EXPECT_EQ(checked, 6000);
    EXPECT_GT(covered, 1000);
}

TEST(Silhouettes, ApexesLieOnTheCoveredSide) {
    for (unsigned seed = 0; seed < 100; ++seed) {
        const auto mesh = to_mesh("soup", random_soup(seed));
        const glm::dmat4 matrix = random_placement(seed);
        const LightPoint light(glm::dvec3(matrix[3]) + glm::dvec3(5.1, -3.3, 4.7), 1);
        const LineCounter lines(*mesh, matrix, light);
        for (const SilhouetteEdge& edge : find_silhouettes(*mesh, edges_of(*mesh), matrix, light)) {
            EXPECT_GE(lines.side(lines.corner(edge.a), lines.corner(edge.b), lines.corner(edge.c)), -1e-9);
            if (edge.d != kNoVertex) {
                EXPECT_GE(lines.side(lines.corner(edge.a), lines.corner(edge.b), lines.corner(edge.d)), -1e-9);
            }
            EXPECT_TRUE(edge.multiplicity > 1 || edge.d == kNoVertex || edge.two_sided);
        }
    }
}

TEST(Silhouettes, BoxOutlineInClosedForm) {
    const auto mesh = to_mesh("box", testing::make_box({2, 2, 2}));
    const MeshEdges edges = edges_of(*mesh);
    // One face seen: 4 edges. Two: 6. Three: 6. Light inside: none.
    EXPECT_EQ(find_silhouettes(*mesh, edges, glm::dmat4(1), {0, 0, 5, 1}).size(), 4u);
    EXPECT_EQ(find_silhouettes(*mesh, edges, glm::dmat4(1), {5, 0, 5, 1}).size(), 6u);
    EXPECT_EQ(find_silhouettes(*mesh, edges, glm::dmat4(1), {5, 6, 7, 1}).size(), 6u);
    EXPECT_EQ(find_silhouettes(*mesh, edges, glm::dmat4(1), {0.2, 0.1, 0.3, 1}).size(), 0u);
    EXPECT_EQ(find_silhouettes(*mesh, edges, glm::dmat4(1), {0.2, 0.1, 0.9, 0}).size(), 6u);
    // In the plane of a face it counts as facing; so does the sun straight above for the four sides.
    EXPECT_EQ(find_silhouettes(*mesh, edges, glm::dmat4(1), {1, 0, 5, 1}).size(), 6u);
    EXPECT_EQ(find_silhouettes(*mesh, edges, glm::dmat4(1), {0, 0, 1, 0}).size(), 4u);
    for (const SilhouetteEdge& edge : find_silhouettes(*mesh, edges, glm::dmat4(1), {5, 6, 7, 1})) {
        EXPECT_EQ(edge.multiplicity, 2);
        EXPECT_FALSE(edge.concave);
        EXPECT_FALSE(edge.two_sided);
        // c belongs to the neighbour that faces the light: nearer to it than d.
        const glm::vec3 light(5, 6, 7);
        EXPECT_LT(glm::distance(mesh->positions[edge.c], light), glm::distance(mesh->positions[edge.d], light));
    }
}

TEST(Silhouettes, FlattenedInstancesCastTheirOutline) {
    const auto mesh = to_mesh("box", testing::make_box({2, 2, 2}));
    glm::dmat4 flat(1);
    flat[2] = glm::dvec4(0);
    const MeshEdges edges = edges_of(*mesh);
    const LightPoint light(0.3, 0.2, 4, 1);
    const LineCounter lines(*mesh, flat, light);
    const auto found = find_silhouettes(*mesh, edges, flat, light);
    for (const double x : {-1.5, -0.5, 0.4, 1.3})
        for (const double y : {-1.4, 0.1, 0.6}) {
            const glm::dvec3 from = glm::dvec3(9.1, 7.7, 0) - glm::dvec3(light),
                             to = glm::dvec3(x, y, 0) - glm::dvec3(light);
            int change = 0;
            for (const SilhouetteEdge& edge : found)
                change += edge.multiplicity * lines.cross(edge.a, edge.b, from, to);
            EXPECT_EQ(change > 0, std::abs(x) < 1 && std::abs(y) < 1) << x << ", " << y;
        }
    flat[1] = glm::dvec4(0);  // a line casts nothing
    EXPECT_TRUE(find_silhouettes(*mesh, edges, flat, light).empty());
    EXPECT_TRUE(find_silhouettes(*mesh, edges, glm::dmat4(0), light).empty());
}

TEST(Silhouettes, ScaleOfTheSceneDoesNotMatter) {
    const auto mesh = to_mesh("sphere", testing::make_sphere(1));
    const MeshEdges edges = edges_of(*mesh);
    const auto plain = find_silhouettes(*mesh, edges, glm::dmat4(1), {3.1, 2.2, 5.3, 1});
    for (const double scale : {1e-12, 1e-4, 1e6, 1e12}) {
        const glm::dmat4 matrix = glm::scale(glm::dmat4(1), glm::dvec3(scale));
        const auto scaled = find_silhouettes(*mesh, edges, matrix, {3.1 * scale, 2.2 * scale, 5.3 * scale, 1});
        ASSERT_EQ(scaled.size(), plain.size());
        for (std::size_t i = 0; i < plain.size(); ++i) {
            EXPECT_EQ(scaled[i].a, plain[i].a);
            EXPECT_EQ(scaled[i].b, plain[i].b);
        }
    }
}

TEST(Silhouettes, ThreadsDoNotChangeTheResult) {
    const auto mesh = to_mesh("sphere", testing::make_sphere(1, 200, 400));
    const MeshEdges edges = edges_of(*mesh);
    ThreadPool threads(3);
    const auto one = find_silhouettes(*mesh, edges, glm::dmat4(1), {3, 2, 5, 1});
    const auto many = find_silhouettes(*mesh, edges, glm::dmat4(1), {3, 2, 5, 1}, {}, &threads);
    ASSERT_EQ(one.size(), many.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        ASSERT_EQ(one[i].a, many[i].a);
        ASSERT_EQ(one[i].c, many[i].c);
    }
    EXPECT_GT(one.size(), 400u);
}

/// A ring with a square section that is hollow in places: bumps make concave edges in every direction.
MeshData bumpy_ring(int segments, int sides) {
    MeshData data;
    for (int i = 0; i < segments; ++i)
        for (int j = 0; j < sides; ++j) {
            const double u = 2 * 3.14159265358979 * i / segments, v = 2 * 3.14159265358979 * j / sides;
            const double radius = 0.4 * (1 + 0.3 * std::cos(3 * v + 2 * u));
            const double reach = 1 + radius * std::cos(v);
            data.positions.push_back(glm::vec3(reach * std::cos(u), reach * std::sin(u), radius * std::sin(v)));
        }
    const auto at = [&](int i, int j) { return std::uint32_t((i % segments) * sides + j % sides); };
    for (int i = 0; i < segments; ++i)
        for (int j = 0; j < sides; ++j) {
            data.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            data.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return data;
}

/// Does a triangle lie between the light and the point, and is the point not on it?
bool is_blocked(const Mesh& mesh, const glm::dvec3& light, const glm::dvec3& point) {
    for (const glm::uvec3& tri : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[tri.x]), b(mesh.positions[tri.y]), c(mesh.positions[tri.z]);
        const glm::dvec3 way = point - light;
        const double u = glm::dot(way, glm::cross(a - light, b - light)),
                     v = glm::dot(way, glm::cross(b - light, c - light)),
                     w = glm::dot(way, glm::cross(c - light, a - light));
        if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) continue;
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        const double t = glm::dot(a - light, normal) / glm::dot(way, normal);
        if (t > 0 && t < 1 - 1e-9) return true;
    }
    return false;
}

TEST(Silhouettes, ConcaveEdgesAreInShadowAlready) {
    for (const bool inward : {false, true}) {
        MeshData data = bumpy_ring(36, 24);
        if (inward)
            for (glm::uvec3& tri : data.triangles) std::swap(tri.x, tri.y);
        const auto mesh = to_mesh("ring", data);
        const MeshEdges edges = edges_of(*mesh);
        int concave = 0;
        for (const glm::dvec3 light : {glm::dvec3(4, 1, 3), glm::dvec3(-2, 3, 0.4), glm::dvec3(2.6, 0, 0.1)}) {
            const auto all = find_silhouettes(*mesh, edges, glm::dmat4(1), {light, 1});
            for (const SilhouetteEdge& edge : all) {
                const glm::dvec3 a(mesh->positions[edge.a]), b(mesh->positions[edge.b]);
                if (!edge.concave) continue;
                ++concave;
                for (const double t : {0.2, 0.5, 0.8})
                    EXPECT_TRUE(is_blocked(*mesh, light, glm::mix(a, b, t))) << "inward " << inward;
            }
            SilhouetteOptions skip;
            skip.skip_concave = true;
            const auto kept = find_silhouettes(*mesh, edges, glm::dmat4(1), {light, 1}, skip);
            const auto flagged = std::count_if(all.begin(), all.end(), [](const auto& edge) { return edge.concave; });
            EXPECT_EQ(kept.size() + std::size_t(flagged), all.size());
        }
        EXPECT_GT(concave, 60);
        // From inside the part's box nothing is taken for granted.
        for (const SilhouetteEdge& edge : find_silhouettes(*mesh, edges, glm::dmat4(1), {0, 0, 0, 1}))
            EXPECT_FALSE(edge.concave);
    }
}

TEST(Silhouettes, FansWithBothSidesCoveredAreMarked) {
    // Three sheets at one edge: seen from the side, one to the left and two to the right.
    const MeshData data{{{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0.1f}, {1, 0, -0.1f}},
                        {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}};
    const auto mesh = to_mesh("fan", data);
    const MeshEdges edges = edges_of(*mesh);
    EXPECT_EQ(edges.adjacency->fan_count, 1u);
    const auto all = find_silhouettes(*mesh, edges, glm::dmat4(1), {0.1, 0.2, 9, 1});
    const auto fan = std::find_if(all.begin(), all.end(), [](const auto& e) { return e.two_sided; });
    ASSERT_NE(fan, all.end());
    EXPECT_EQ(fan->multiplicity, 1);
    SilhouetteOptions skip;
    skip.skip_two_sided = true;
    EXPECT_EQ(find_silhouettes(*mesh, edges, glm::dmat4(1), {0.1, 0.2, 9, 1}, skip).size(), all.size() - 1);
}

}  // namespace
}  // namespace shadow_layers
