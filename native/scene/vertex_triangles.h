// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "shadow_layers/scene.h"

namespace shadow_layers {

/// Which triangles of a mesh use a vertex, by its index: vertices at the same place are not one here. Several times
/// cheaper than MeshAdjacency, which welds and connects edges.
struct VertexTriangles {
    std::vector<std::uint32_t> first;      ///< per vertex its first entry in `triangles`, and one past the last
    std::vector<std::uint32_t> triangles;  ///< vertex by vertex, ascending

    std::span<const std::uint32_t> of(std::uint32_t vertex) const {
        return std::span(triangles).subspan(first[vertex], first[vertex + 1] - first[vertex]);
    }
    std::size_t byte_size() const { return (first.capacity() + triangles.capacity()) * sizeof(std::uint32_t); }
};

/// O(vertices + triangles). Depends on nothing but what Mesh::topology_key is the key of.
std::shared_ptr<const VertexTriangles> make_vertex_triangles(const Mesh& mesh);

}  // namespace shadow_layers
