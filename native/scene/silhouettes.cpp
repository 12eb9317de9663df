// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/silhouettes.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/thread_pool.h"

namespace shadow_layers {

namespace {

enum Side : std::uint8_t { kFacing = 0, kAway = 1, kNoArea = 2 };

constexpr std::size_t kTriangleBlock = 1 << 14, kEdgeBlock = 1 << 15;

void run(ThreadPool* threads, std::size_t count, std::size_t block,
         const std::function<void(std::size_t, std::size_t)>& body) {
    if (threads)
        threads->parallel_for(count, block, body);
    else
        for (std::size_t begin = 0; begin < count; begin += block) body(begin, std::min(begin + block, count));
}

glm::dvec3 compute_winding_normal(const Mesh& mesh, std::uint32_t triangle) {
    const glm::uvec3& tri = mesh.triangles[triangle];
    const glm::dvec3 p(mesh.positions[tri.x]);
    return glm::cross(glm::dvec3(mesh.positions[tri.y]) - p, glm::dvec3(mesh.positions[tri.z]) - p);
}

std::vector<std::uint8_t> find_sides(const Mesh& mesh, const glm::dvec4& light, ThreadPool* threads) {
    std::vector<std::uint8_t> sides(mesh.triangles.size());
    const glm::dvec3 towards(light);
    run(threads, sides.size(), kTriangleBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const glm::dvec3 normal = compute_winding_normal(mesh, std::uint32_t(t));
            const glm::dvec3 corner(mesh.positions[mesh.triangles[t].x]);
            const double side = glm::dot(towards - light.w * corner, normal);
            sides[t] = normal == glm::dvec3(0) ? kNoArea : side < 0 ? kAway : kFacing;
        }
    });
    return sides;
}

/// Classifies the edges of one mesh for one light.
class EdgeFinder {
public:
    EdgeFinder(const Mesh& mesh, const MeshEdges& edges, const glm::dvec4& light, const SilhouetteOptions& options,
               ThreadPool* threads)
        : mesh_(mesh),
          adjacency_(*edges.adjacency),
          options_(options),
          sides_(find_sides(mesh, light, threads)),
          outward_(find_outward(*edges.shapes, light)) {}

    void collect(std::uint32_t begin, std::uint32_t end, std::vector<SilhouetteEdge>& found) const {
        std::uint32_t e = begin;
        for (; e < std::min(end, adjacency_.pair_count); ++e) {
            const EdgeUse first = adjacency_.uses[2 * std::size_t(e)], second = adjacency_.uses[2 * std::size_t(e) + 1];
            const unsigned s = sides_[first.triangle()], t = sides_[second.triangle()];
            // Two triangles that run along the edge in opposite ways, once turned to the light, cancel: by far the
            // most.
            if (!((s | t) & kNoArea) && (((first.packed ^ second.packed) & 1u) ^ s ^ t)) continue;
            add(e, found);
        }
        for (; e < end; ++e) add(e, found);
    }

private:
    /// Which way is out per component, 0 where the light may be inside: there nothing is known to be in shadow.
    static std::vector<std::int8_t> find_outward(const ComponentShapes& shapes, const glm::dvec4& light) {
        std::vector<std::int8_t> outward = shapes.orientation;
        if (light.w == 0) return outward;
        const glm::dvec3 place = glm::dvec3(light) / light.w;
        for (std::size_t c = 0; c < outward.size(); ++c) {
            const Bounds& box = shapes.bounds[c];
            const glm::dvec3 margin = 1e-6 * (box.max - box.min);
            if (glm::all(glm::greaterThanEqual(place, box.min - margin)) &&
                glm::all(glm::lessThanEqual(place, box.max + margin)))
                outward[c] = 0;
        }
        return outward;
    }

    /// The corner of the triangle that is not on the edge.
    std::uint32_t find_apex(std::uint32_t triangle, const glm::uvec2& edge) const {
        const glm::uvec3& tri = mesh_.triangles[triangle];
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t v = adjacency_.weld[tri[k]];
            if (v != edge.x && v != edge.y) return v;
        }
        return kNoVertex;
    }

    bool is_concave(EdgeUse first, EdgeUse second, std::uint32_t apex_of_second) const {
        const int out = outward_[adjacency_.component[first.triangle()]];
        if (out == 0 || first.reversed() == second.reversed()) return false;
        const glm::dvec3 corner(mesh_.positions[mesh_.triangles[first.triangle()].x]);
        const glm::dvec3 apex(mesh_.positions[apex_of_second]);
        return out * glm::dot(compute_winding_normal(mesh_, first.triangle()), apex - corner) > 0;
    }

    void add(std::uint32_t e, std::vector<SilhouetteEdge>& found) const {
        int left = 0, right = 0;
        const auto uses = adjacency_.uses_of(e);
        for (const EdgeUse use : uses) {
            const unsigned side = sides_[use.triangle()];
            if (side != kNoArea) ++((unsigned(use.reversed()) ^ side) ? right : left);
        }
        if (left == right) return;
        const bool swapped = right > left;
        SilhouetteEdge edge;
        const glm::uvec2 ends = adjacency_.edge_vertices[e];
        edge.a = swapped ? ends.y : ends.x;
        edge.b = swapped ? ends.x : ends.y;
        edge.multiplicity = std::int16_t(std::min(std::abs(left - right), 0x7fff));
        edge.two_sided = std::min(left, right) > 0;
        if (options_.skip_two_sided && edge.two_sided) return;

        EdgeUse chosen[2];
        int count = 0;
        for (const unsigned wanted : {kFacing, kAway})
            for (const EdgeUse use : uses) {
                const unsigned side = sides_[use.triangle()];
                if (side == wanted && ((unsigned(use.reversed()) ^ side) != 0) == swapped && count < 2)
                    chosen[count++] = use;
            }
        edge.c = find_apex(chosen[0].triangle(), ends);
        if (count > 1) {
            edge.d = find_apex(chosen[1].triangle(), ends);
            edge.concave = uses.size() == 2 && is_concave(chosen[0], chosen[1], edge.d);
            if (options_.skip_concave && edge.concave) return;
        }
        found.push_back(edge);
    }

    const Mesh& mesh_;
    const MeshAdjacency& adjacency_;
    SilhouetteOptions options_;
    std::vector<std::uint8_t> sides_;
    std::vector<std::int8_t> outward_;
};

}  // namespace

glm::dvec4 compute_light_in_object(const glm::dmat4& world_from_object, const LightPoint& light_ws) {
    // With M = s M' the light is s^2 (adj(M') (l - w t), s w det(M')): without s^2 tiny scales do not underflow.
    double scale = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) scale = std::max(scale, std::abs(world_from_object[i][j]));
    if (scale == 0) return glm::dvec4(0);
    const glm::dvec3 x = glm::dvec3(world_from_object[0]) / scale, y = glm::dvec3(world_from_object[1]) / scale,
                     z = glm::dvec3(world_from_object[2]) / scale;
    const glm::dvec3 yz = glm::cross(y, z), zx = glm::cross(z, x), xy = glm::cross(x, y);
    const glm::dvec3 from_origin = glm::dvec3(light_ws) - light_ws.w * glm::dvec3(world_from_object[3]);
    return {glm::dot(yz, from_origin), glm::dot(zx, from_origin), glm::dot(xy, from_origin),
            light_ws.w * scale * glm::dot(x, yz)};
}

std::vector<SilhouetteEdge> find_silhouettes(const Mesh& mesh, const MeshEdges& edges,
                                             const glm::dmat4& world_from_object, const LightPoint& light_ws,
                                             const SilhouetteOptions& options, ThreadPool* threads) {
    const glm::dvec4 light = compute_light_in_object(world_from_object, light_ws);
    if (light == glm::dvec4(0)) return {};  // flattened to a line, or to a plane that holds the light
    const EdgeFinder finder(mesh, edges, light, options, threads);
    const std::size_t count = edges.adjacency->edge_count();
    std::vector<std::vector<SilhouetteEdge>> found((count + kEdgeBlock - 1) / kEdgeBlock);
    run(threads, count, kEdgeBlock, [&](std::size_t begin, std::size_t end) {
        finder.collect(std::uint32_t(begin), std::uint32_t(end), found[begin / kEdgeBlock]);
    });
    std::vector<SilhouetteEdge> all;
    std::size_t total = 0;
    for (const auto& block : found) total += block.size();
    all.reserve(total);
    for (const auto& block : found) all.insert(all.end(), block.begin(), block.end());
    return all;
}

}  // namespace shadow_layers
