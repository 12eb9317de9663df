// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "shadow_layers/scene.h"

namespace shadow_layers {

class ThreadPool;

inline constexpr std::uint32_t kNoVertex = 0xffffffffu;

/// A triangle at an edge, with the way in which its stored winding runs along that edge.
struct EdgeUse {
    std::uint32_t packed = 0;  ///< triangle * 2 + (1 if the winding runs from the edge's b to its a)
    std::uint32_t triangle() const { return packed >> 1; }
    bool reversed() const { return packed & 1u; }
};

/// Who shares an edge with whom, by position and not by index: vertices at exactly the same place (-0 equals 0) are
/// one.
///
/// Left out: triangles with a vertex that is not usable (scene/bounds.h) and triangles with two vertices in one place.
/// Triangles with three different vertices on a line are kept, because that is a matter of positions: find_silhouettes
/// leaves them out.
///
/// Edges are sorted by kind: first those with two triangles, then boundaries with one, then fans with three or more.
struct MeshAdjacency {
    std::vector<std::uint32_t> weld;        ///< per vertex: the lowest vertex number at its place
    std::vector<glm::uvec2> edge_vertices;  ///< per edge: a < b, welded numbers
    std::vector<EdgeUse> uses;              ///< 2 per pair, 1 per boundary, then those of the fans
    std::vector<std::uint32_t> fan_first;   ///< per fan its first entry in `uses`, and one past the last
    std::uint32_t pair_count = 0, boundary_count = 0, fan_count = 0;

    std::vector<std::uint32_t> component;        ///< per triangle: its edge-connected part; kNoVertex if left out
    std::vector<std::uint8_t> component_closed;  ///< 1: every edge is run through equally often both ways
    std::uint32_t dropped_count = 0;             ///< triangles left out
    bool all_usable = true;                      ///< every vertex is usable

    std::uint32_t edge_count() const { return pair_count + boundary_count + fan_count; }
    /// The triangles at edge `e`.
    std::span<const EdgeUse> uses_of(std::uint32_t e) const;
    std::size_t byte_size() const;
};

/// Welds and connects. O(vertices + triangles); the result does not depend on the number of threads.
std::shared_ptr<const MeshAdjacency> make_adjacency(const Mesh& mesh, ThreadPool* threads = nullptr);

/// Would welding `mesh`, which has the topology that `adjacency` was made from, give the same again? Exact, several
/// times cheaper than welding: vertices of a class must still coincide, and no two classes may have come together.
bool still_holds(const MeshAdjacency& adjacency, const Mesh& mesh);

/// Which way out is, for the closed parts of a mesh at given positions.
struct ComponentShapes {
    /// +1: stored windings face outward; -1: inward; 0: open, inconsistent or flat, so that there is no inside.
    std::vector<std::int8_t> orientation;
    std::vector<Bounds> bounds;  ///< object space
    std::size_t byte_size() const;
};
ComponentShapes measure_components(const Mesh& mesh, const MeshAdjacency& adjacency);

/// What find_silhouettes needs of a mesh.
struct MeshEdges {
    std::shared_ptr<const MeshAdjacency> adjacency;
    std::shared_ptr<const ComponentShapes> shapes;
};

}  // namespace shadow_layers
