// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mesh_data_cache.h"

namespace shadow_layers {
namespace {

/// Of a mesh at its positions. Names its adjacency rather than holding it, so that what is dropped is free.
struct KeptShapes {
    ContentKey adjacency_key;
    std::shared_ptr<const ComponentShapes> shapes;
    std::size_t byte_size() const { return sizeof *this + shapes->byte_size(); }
};

}  // namespace

MeshEdges MeshDataCache::get_edges(const Mesh& mesh, ThreadPool* threads) {
    const ContentKey key = compute_mesh_key(mesh);
    if (const auto kept = find<KeptShapes>(key))
        if (const auto adjacency = find<MeshAdjacency>(kept->adjacency_key)) return {adjacency, kept->shapes};
    auto [adjacency, adjacency_key] = find_in_group<MeshAdjacency>(
        mesh.topology_key, [&](const MeshAdjacency& candidate) { return still_holds(candidate, mesh); });
    if (!adjacency) {
        adjacency = make_adjacency(mesh, threads);
        adjacency_key = key;
        insert<MeshAdjacency>(adjacency_key, adjacency, mesh.topology_key);
    }
    auto shapes = std::make_shared<const ComponentShapes>(measure_components(mesh, *adjacency));
    insert<KeptShapes>(key, std::make_shared<const KeptShapes>(KeptShapes{adjacency_key, shapes}));
    return {adjacency, shapes};
}

}  // namespace shadow_layers
