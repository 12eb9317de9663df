// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <glm/glm.hpp>
#include <list>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
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

/// Keeps adjacencies between frames. An adjacency is found by the topology key and used again for deformed positions
/// while still_holds; so an animated mesh is welded once, yet every frame gets exactly what a fresh weld would give.
class AdjacencyCache {
public:
    explicit AdjacencyCache(std::size_t budget_bytes = std::size_t{512} << 20) : budget_bytes_(budget_bytes) {}

    MeshEdges get(const Mesh& mesh, ThreadPool* threads = nullptr);
    /// Uses from now on count for this render; what was last used `kept` renders before it is dropped.
    void begin_render(std::uint64_t render, std::uint64_t kept);
    void clear();
    std::size_t bytes() const { return bytes_; }
    std::size_t weld_count() const { return weld_count_; }  ///< welds worked so far, for tests

private:
    /// A weld, and the shapes of the last few sets of positions that it was found to hold for.
    struct Entry {
        ContentKey topology_key;
        std::shared_ptr<const MeshAdjacency> adjacency;
        std::deque<std::pair<ContentKey, std::shared_ptr<const ComponentShapes>>> shapes;
        std::uint64_t last_render = 0;
    };
    struct KeyHash {
        std::size_t operator()(const ContentKey& key) const { return std::size_t(key.low); }
    };
    using Entries = std::list<Entry>;
    MeshEdges add_shapes(Entries::iterator entry, const Mesh& mesh);
    void use(Entries::iterator entry);
    void trim();
    void drop_last();

    Entries entries_;  ///< most recently used first
    std::unordered_multimap<ContentKey, Entries::iterator, KeyHash> by_topology_;
    std::size_t budget_bytes_, bytes_ = 0, weld_count_ = 0;
    std::uint64_t render_ = 0;
};

}  // namespace shadow_layers
