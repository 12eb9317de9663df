// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/frame.h"

#include "frame/camera_window.h"

namespace shadow_layers {

Frame::Ray Frame::ray_at(double x_px, double y_px) const {
    const RayBasis basis(camera, width, height);
    return {basis.origin_at(x_px, y_px), basis.direction_at(x_px, y_px)};
}

std::array<glm::dvec3, 3> Frame::get_corners_rel(const PixelIds& triangle_ids) const {
    return find_corners_rel(*scene, origin_ws, triangle_ids);
}

std::array<glm::dvec3, 3> find_corners_rel(const Scene& scene, const glm::dvec3& origin_ws, const PixelIds& triangle) {
    const Instance& instance = scene.instances[triangle.instance];
    const Mesh& mesh = *scene.meshes[instance.mesh];
    const glm::dmat3 linear(instance.world_from_object);
    const glm::dvec3 offset = glm::dvec3(instance.world_from_object[3]) - origin_ws;
    const glm::uvec3& corners = mesh.triangles[triangle.triangle];
    return {linear * glm::dvec3(mesh.positions[corners.x]) + offset,
            linear * glm::dvec3(mesh.positions[corners.y]) + offset,
            linear * glm::dvec3(mesh.positions[corners.z]) + offset};
}

}  // namespace shadow_layers
