// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/bounds.h"

namespace shadow_layers {

Bounds compute_mesh_bounds(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    glm::vec3 low(kInf), high(-kInf);
    for (const glm::uvec3& triangle : triangles)
        for (int k = 0; k < 3; ++k) {
            const glm::vec3& p = positions[triangle[k]];
            if (!is_usable_vertex(p)) continue;
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    Bounds bounds;
    bounds.min = low;
    bounds.max = high;
    return bounds;
}

Bounds transform_bounds(const Bounds& bounds, const glm::dmat4& matrix) {
    if (bounds.is_empty()) return bounds;
    const glm::dvec3 middle = 0.5 * (bounds.min + bounds.max), half = 0.5 * (bounds.max - bounds.min);
    const auto linear = glm::dmat3(matrix);
    const glm::dvec3 centre = linear * middle + glm::dvec3(matrix[3]);
    const glm::dvec3 half_extent =
        glm::abs(linear[0]) * half.x + glm::abs(linear[1]) * half.y + glm::abs(linear[2]) * half.z;
    return {centre - half_extent, centre + half_extent};
}

Bounds compute_instance_bounds(const Scene& scene, const Instance& instance) {
    return transform_bounds(scene.meshes[instance.mesh]->bounds, instance.world_from_object);
}

Bounds compute_scene_bounds(const Scene& scene, std::uint32_t flags) {
    Bounds bounds;
    for (const Instance& instance : scene.instances)
        if (instance.flags & flags) bounds.add(compute_instance_bounds(scene, instance));
    return bounds;
}

}  // namespace shadow_layers
