// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "base/content_cache.h"
#include "base/hash.h"
#include "scene/adjacency.h"

namespace shadow_layers {

/// What is derived from meshes on the host, kept between frames within one budget: adjacency, clusters, the triangles
/// at a vertex, trees. The key of a mesh is part of each value's key; a type of value that has parameters of its own is
/// kept by ContentCache::get.
class MeshDataCache : public ContentCache {
public:
    using ContentCache::ContentCache;

    /// Of a value that depends on the mesh's topology alone. `make()` gives a std::shared_ptr<const T>.
    template <class T, class Make>
    std::shared_ptr<const T> get_for_topology(const Mesh& mesh, const Make& make) {
        return get<T>(mesh.topology_key, make);
    }
    /// Of a value that depends on topology and positions. `make(other)` gets the last one made for the same topology at
    /// other positions, as a std::shared_ptr<const T>: something to start from. Null if there is none.
    template <class T, class Make>
    std::shared_ptr<const T> get_for_mesh(const Mesh& mesh, const Make& make) {
        const ContentKey key = compute_mesh_key(mesh);
        if (auto found = find<T>(key)) return found;
        const auto other = find_in_group<T>(mesh.topology_key, [](const T&) { return true; }).first;
        std::shared_ptr<const T> value = make(other);
        insert<T>(key, value, mesh.topology_key);
        return value;
    }
    /// Welded and connected. An adjacency is found by the topology and used again for deformed positions while
    /// still_holds; so an animated mesh is welded once, yet every frame gets exactly what a fresh weld would give.
    MeshEdges get_edges(const Mesh& mesh, ThreadPool* threads = nullptr);

private:
    static ContentKey compute_mesh_key(const Mesh& mesh) {
        return KeyBuilder("mesh").add(mesh.positions_key).add(mesh.topology_key).key();
    }
};

}  // namespace shadow_layers
