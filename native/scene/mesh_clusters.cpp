// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mesh_clusters.h"

#include <algorithm>
#include <limits>

#include "base/thread_pool.h"
#include "scene/bounds.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kClusterBlock = 16;

MeshClusters::Box find_box(const Mesh& mesh, std::size_t begin, std::size_t end) {
    MeshClusters::Box box{glm::vec3(std::numeric_limits<float>::infinity()),
                          glm::vec3(-std::numeric_limits<float>::infinity())};
    for (std::size_t t = begin; t < end; ++t) {
        for (int k = 0; k < 3; ++k) {
            const glm::vec3& p = mesh.positions[mesh.triangles[t][k]];
            if (!is_usable_vertex(p)) continue;
            box.min = glm::min(box.min, p);
            box.max = glm::max(box.max, p);
        }
    }
    return box;
}

}  // namespace

MeshClusters make_mesh_clusters(const Mesh& mesh, ThreadPool* threads) {
    const std::size_t total = mesh.triangles.size();
    MeshClusters clusters;
    clusters.boxes.resize((total + kClusterTriangles - 1) / kClusterTriangles);
    const auto find = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            clusters.boxes[i] = find_box(mesh, i * kClusterTriangles, std::min((i + 1) * kClusterTriangles, total));
    };
    if (threads)
        threads->parallel_for(clusters.boxes.size(), kClusterBlock, find);
    else
        find(0, clusters.boxes.size());
    return clusters;
}

}  // namespace shadow_layers
