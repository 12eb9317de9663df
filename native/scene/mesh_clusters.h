// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "shadow_layers/scene.h"

namespace shadow_layers {

class ThreadPool;

/// Triangles of one cluster.
inline constexpr std::size_t kClusterTriangles = 128;

/// A mesh cut into runs of kClusterTriangles triangles, as its triangles follow one another, each with the box round
/// its usable vertices: what lies nowhere near is passed over at once.
struct MeshClusters {
    struct Box {
        glm::vec3 min, max;  ///< object space; min > max: nothing to draw
        bool is_empty() const { return !(min.x <= max.x); }
    };
    std::vector<Box> boxes;
    std::size_t byte_size() const { return boxes.size() * sizeof(Box); }
};

MeshClusters make_mesh_clusters(const Mesh& mesh, ThreadPool* threads = nullptr);

}  // namespace shadow_layers
