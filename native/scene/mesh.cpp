// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "base/hash.h"
#include "scene/bounds.h"
#include "shadow_layers/error.h"

namespace shadow_layers {

namespace {

/// Triangle numbers carry a bit of their own in the adjacency; vertex numbers need one value for "none".
constexpr std::size_t kMostTriangles = (std::size_t{1} << 31) - 1;
constexpr std::size_t kMostVertices = std::numeric_limits<std::uint32_t>::max();

void check_counts(const std::string& name, std::size_t vertex_count, std::size_t triangle_count) {
    if (vertex_count >= kMostVertices)
        throw InputError("mesh \"" + name + "\" has " + std::to_string(vertex_count) + " vertices; at most " +
                         std::to_string(kMostVertices - 1) + " are possible: split it");
    if (triangle_count > kMostTriangles)
        throw InputError("mesh \"" + name + "\" has " + std::to_string(triangle_count) + " triangles; at most " +
                         std::to_string(kMostTriangles) + " are possible: split it");
}

[[noreturn]] void refuse_index(const std::string& name, std::size_t triangle, std::uint32_t index, std::size_t count) {
    throw InputError("mesh \"" + name + "\": triangle " + std::to_string(triangle) + " uses vertex " +
                     std::to_string(index) + ", but the mesh has " + std::to_string(count) +
                     " vertices; its triangles and positions don't belong together");
}

}  // namespace

std::shared_ptr<const Mesh> make_mesh(std::string name, std::span<const glm::vec3> positions,
                                      std::span<const glm::uvec3> triangles, std::shared_ptr<const void> owner) {
    check_counts(name, positions.size(), triangles.size());
    const auto count = std::uint32_t(positions.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            if (triangles[t][k] >= count) refuse_index(name, t, triangles[t][k], count);

    auto mesh = std::make_shared<Mesh>();
    mesh->name = std::move(name);
    mesh->positions = positions;
    mesh->triangles = triangles;
    mesh->owner = std::move(owner);
    // The vertex count is part of the topology: welding is per vertex, also for those that no triangle uses.
    mesh->positions_key = KeyBuilder("positions").add_span(positions).key();
    mesh->topology_key = KeyBuilder("topology").add(positions.size()).add_span(triangles).key();
    mesh->bounds = compute_mesh_bounds(positions, triangles);
    return mesh;
}

}  // namespace shadow_layers
