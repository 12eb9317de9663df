// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/vertex_triangles.h"

#include <numeric>

namespace shadow_layers {

std::shared_ptr<const VertexTriangles> make_vertex_triangles(const Mesh& mesh) {
    auto result = std::make_shared<VertexTriangles>();
    // Counted one place ahead, so that filling moves each vertex's start to where it belongs.
    std::vector<std::uint32_t> ends(mesh.positions.size() + 2, 0);
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int k = 0; k < 3; ++k) ++ends[triangle[k] + 2];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    result->triangles.resize(3 * mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) result->triangles[ends[mesh.triangles[t][k] + 1]++] = t;
    ends.pop_back();
    result->first = std::move(ends);
    return result;
}

}  // namespace shadow_layers
