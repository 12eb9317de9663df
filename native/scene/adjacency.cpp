// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/adjacency.h"

#include <algorithm>
#include <numeric>

#include "base/thread_pool.h"
#include "scene/bounds.h"
#include "scene/weld.h"

namespace shadow_layers {

namespace {

/// One triangle's use of an edge, filed under the edge's lower vertex.
struct HalfEdge {
    std::uint32_t other = 0;  ///< the edge's higher vertex
    EdgeUse use;
    bool operator<(const HalfEdge& that) const {
        return other != that.other ? other < that.other : use.packed < that.use.packed;
    }
};

struct HalfEdges {
    std::vector<std::uint32_t> first;  ///< per vertex its first entry, and one past the last
    std::vector<HalfEdge> entries;
};

void run(ThreadPool* threads, std::size_t count, std::size_t block,
         const std::function<void(std::size_t, std::size_t)>& body) {
    if (threads)
        threads->parallel_for(count, block, body);
    else
        body(0, count);
}

/// The welded corners of the triangles that have edges; others get kNoVertex in x.
std::vector<glm::uvec3> weld_triangles(const Mesh& mesh, MeshAdjacency& made) {
    std::vector<glm::uvec3> corners(mesh.triangles.size());
    for (std::size_t t = 0; t < corners.size(); ++t) {
        const glm::uvec3& tri = mesh.triangles[t];
        glm::uvec3 c(made.weld[tri.x], made.weld[tri.y], made.weld[tri.z]);
        const bool usable =
            made.all_usable || (is_usable_vertex(mesh.positions[tri.x]) && is_usable_vertex(mesh.positions[tri.y]) &&
                                is_usable_vertex(mesh.positions[tri.z]));
        if (!usable || c.x == c.y || c.y == c.z || c.z == c.x) {
            c.x = kNoVertex;
            ++made.dropped_count;
        }
        corners[t] = c;
    }
    return corners;
}

/// Counting sort of all half-edges by their lower vertex, then a small sort within each vertex.
HalfEdges sort_half_edges(const std::vector<glm::uvec3>& corners, std::size_t vertex_count, ThreadPool* threads) {
    HalfEdges sorted;
    sorted.first.assign(vertex_count + 1, 0);
    for (const glm::uvec3& c : corners)
        if (c.x != kNoVertex)
            for (int k = 0; k < 3; ++k) ++sorted.first[std::min(c[k], c[(k + 1) % 3]) + 1];
    std::partial_sum(sorted.first.begin(), sorted.first.end(), sorted.first.begin());
    sorted.entries.resize(sorted.first.back());
    std::vector<std::uint32_t> next(sorted.first.begin(), sorted.first.end() - 1);
    for (std::size_t t = 0; t < corners.size(); ++t) {
        const glm::uvec3& c = corners[t];
        if (c.x == kNoVertex) continue;
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t from = c[k], to = c[(k + 1) % 3];
            const std::uint32_t packed = std::uint32_t(t) * 2 + (from > to ? 1u : 0u);
            sorted.entries[next[std::min(from, to)]++] = {std::max(from, to), EdgeUse{packed}};
        }
    }
    run(threads, vertex_count, 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            std::sort(sorted.entries.begin() + sorted.first[v], sorted.entries.begin() + sorted.first[v + 1]);
    });
    return sorted;
}

/// Groups half-edges into edges, sorted by kind.
void collect_edges(const HalfEdges& sorted, MeshAdjacency& made) {
    struct Kind {
        std::vector<glm::uvec2> vertices;
        std::vector<EdgeUse> uses;
    };
    Kind pairs, boundaries, fans;
    pairs.vertices.reserve(sorted.entries.size() / 2);
    pairs.uses.reserve(sorted.entries.size());
    std::vector<std::uint32_t> fan_sizes;
    for (std::uint32_t v = 0; v + 1 < sorted.first.size(); ++v)
        for (std::uint32_t i = sorted.first[v]; i < sorted.first[v + 1];) {
            std::uint32_t end = i + 1;
            while (end < sorted.first[v + 1] && sorted.entries[end].other == sorted.entries[i].other) ++end;
            const std::uint32_t count = end - i;
            Kind& kind = count == 2 ? pairs : count == 1 ? boundaries : fans;
            kind.vertices.push_back({v, sorted.entries[i].other});
            for (std::uint32_t j = i; j < end; ++j) kind.uses.push_back(sorted.entries[j].use);
            if (count > 2) fan_sizes.push_back(count);
            i = end;
        }
    made.pair_count = std::uint32_t(pairs.vertices.size());
    made.boundary_count = std::uint32_t(boundaries.vertices.size());
    made.fan_count = std::uint32_t(fans.vertices.size());
    made.edge_vertices = std::move(pairs.vertices);
    made.uses = std::move(pairs.uses);
    for (const Kind* kind : {&boundaries, &fans}) {
        made.edge_vertices.insert(made.edge_vertices.end(), kind->vertices.begin(), kind->vertices.end());
        made.uses.insert(made.uses.end(), kind->uses.begin(), kind->uses.end());
    }
    made.fan_first.assign(1, 2 * made.pair_count + made.boundary_count);
    for (const std::uint32_t size : fan_sizes) made.fan_first.push_back(made.fan_first.back() + size);
}

/// Edge-connected parts by union-find (path halving, lower number wins), and whether each is closed.
void connect_components(const std::vector<glm::uvec3>& corners, MeshAdjacency& made) {
    std::vector<std::uint32_t> parent(corners.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root_of = [&](std::uint32_t t) {
        while (parent[t] != t) t = parent[t] = parent[parent[t]];
        return t;
    };
    for (std::uint32_t e = 0; e < made.edge_count(); ++e) {
        const auto uses = made.uses_of(e);
        for (std::size_t i = 1; i < uses.size(); ++i) {
            const std::uint32_t p = root_of(uses[0].triangle()), q = root_of(uses[i].triangle());
            parent[std::max(p, q)] = std::min(p, q);
        }
    }
    made.component.assign(corners.size(), kNoVertex);
    std::uint32_t count = 0;
    for (std::uint32_t t = 0; t < corners.size(); ++t) {
        if (corners[t].x == kNoVertex) continue;
        const std::uint32_t root = root_of(t);
        made.component[t] = root == t ? count++ : made.component[root];
    }
    made.component_closed.assign(count, 1);
    for (std::uint32_t e = 0; e < made.edge_count(); ++e) {
        const auto uses = made.uses_of(e);
        int balance = 0;
        for (const EdgeUse use : uses) balance += use.reversed() ? -1 : 1;
        if (balance != 0) made.component_closed[made.component[uses[0].triangle()]] = 0;
    }
}

}  // namespace

std::span<const EdgeUse> MeshAdjacency::uses_of(std::uint32_t e) const {
    if (e < pair_count) return {&uses[2 * std::size_t(e)], 2};
    if (e < pair_count + boundary_count) return {&uses[std::size_t(pair_count) + e], 1};
    const std::uint32_t fan = e - pair_count - boundary_count;
    return {&uses[fan_first[fan]], fan_first[fan + 1] - fan_first[fan]};
}

std::size_t MeshAdjacency::byte_size() const {
    return sizeof *this + weld.size() * 4 + edge_vertices.size() * 8 + uses.size() * 4 + fan_first.size() * 4 +
           component.size() * 4 + component_closed.size();
}

std::shared_ptr<const MeshAdjacency> make_adjacency(const Mesh& mesh, ThreadPool* threads) {
    auto made = std::make_shared<MeshAdjacency>();
    made->weld = weld_vertices(mesh.positions);
    made->all_usable = std::all_of(mesh.positions.begin(), mesh.positions.end(), is_usable_vertex);
    const std::vector<glm::uvec3> corners = weld_triangles(mesh, *made);
    collect_edges(sort_half_edges(corners, mesh.positions.size(), threads), *made);
    connect_components(corners, *made);
    return made;
}

bool still_holds(const MeshAdjacency& adjacency, const Mesh& mesh) {
    return adjacency.all_usable && weld_still_holds(adjacency.weld, mesh.positions);
}

std::size_t ComponentShapes::byte_size() const {
    return sizeof *this + orientation.size() + bounds.size() * sizeof(Bounds);
}

ComponentShapes measure_components(const Mesh& mesh, const MeshAdjacency& adjacency) {
    const std::size_t count = adjacency.component_closed.size();
    ComponentShapes shapes;
    shapes.orientation.assign(count, 0);
    shapes.bounds.assign(count, Bounds());
    std::vector<double> volume(count, 0.0);
    std::vector<glm::dvec3> corner(count);  // volumes are taken about a vertex of the part: far parts keep precision
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::uint32_t c = adjacency.component[t];
        if (c == kNoVertex || !adjacency.component_closed[c]) continue;
        const glm::uvec3& tri = mesh.triangles[t];
        const glm::dvec3 p(mesh.positions[tri.x]), q(mesh.positions[tri.y]), r(mesh.positions[tri.z]);
        if (shapes.bounds[c].is_empty()) corner[c] = p;
        volume[c] += glm::dot(p - corner[c], glm::cross(q - corner[c], r - corner[c]));
        shapes.bounds[c].add(p), shapes.bounds[c].add(q), shapes.bounds[c].add(r);
    }
    for (std::size_t c = 0; c < count; ++c) {
        if (shapes.bounds[c].is_empty()) continue;
        const glm::dvec3 size = shapes.bounds[c].max - shapes.bounds[c].min;
        const double diagonal = glm::length(size);
        // Rounding of the sum stays far below 1e-12 of the cube round the part; less than that has no inside.
        if (std::abs(volume[c]) > 1e-12 * diagonal * diagonal * diagonal)
            shapes.orientation[c] = volume[c] > 0 ? 1 : -1;
    }
    return shapes;
}

}  // namespace shadow_layers
