// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/occlusion_rule.h"

#include <algorithm>
#include <cmath>

namespace shadow_layers {
namespace {

// A corner is off by half a unit in the last place on each axis, and so are those that the plane goes through.
constexpr double kCornerRounding = 4.0 / 16777216.0;  // 2^-22

bool comes_before(const glm::dvec3& p, const glm::dvec3& q) {
    if (p.x != q.x) return p.x < q.x;
    return p.y != q.y ? p.y < q.y : p.z < q.z;
}

/// Volume spanned by the direction and the edge from p to q, with exactly opposite signs for q to p.
double compute_edge_volume(const glm::dvec3& direction, const glm::dvec3& p, const glm::dvec3& q) {
    return comes_before(p, q) ? glm::dot(direction, glm::cross(p, q)) : -glm::dot(direction, glm::cross(q, p));
}

bool is_neighbour_in_plane(const std::array<glm::dvec3, 3>& own, const std::array<glm::dvec3, 3>& other) {
    int shared = 0;
    glm::dvec3 apex(0.0);
    for (const glm::dvec3& corner : other) {
        if (corner == own[0] || corner == own[1] || corner == own[2])
            ++shared;
        else
            apex = corner;
    }
    if (shared != 2) return shared == 3;
    const glm::dvec3 normal = glm::cross(own[1] - own[0], own[2] - own[0]), offset = apex - own[0];
    return std::abs(glm::dot(normal, offset)) <= kFlatTolerance * glm::length(normal) * glm::length(offset);
}

}  // namespace

OcclusionRule::OcclusionRule(const ReceiverSource& receivers, const LightSample& sample) : receivers_(receivers) {
    sample_.directional = sample.directional;
    sample_.position_ws = sample.position_ws;
    sample_.to_light_ws = sample.to_light_ws;
}

bool OcclusionRule::is_blocked(const glm::dvec3& receiver_rel, const PixelIds& receiver, const PixelIds& caster) const {
    return is_blocked(receiver_rel, receiver, caster, sample_);
}

bool OcclusionRule::is_blocked(const glm::dvec3& receiver_rel, const PixelIds& receiver, const PixelIds& caster,
                               const LightSample& sample) const {
    if (receiver.instance == caster.instance && receiver.triangle == caster.triangle) return false;
    const std::array<glm::dvec3, 3> corners = receivers_.get_corners_rel(caster);
    const bool directional = sample.directional;
    const glm::dvec3 to_light =
        directional ? sample.to_light_ws : sample.position_ws - receivers_.origin_ws - receiver_rel;
    const glm::dvec3 a = corners[0] - receiver_rel, b = corners[1] - receiver_rel, c = corners[2] - receiver_rel;
    const double u = compute_edge_volume(to_light, b, c), v = compute_edge_volume(to_light, c, a),
                 w = compute_edge_volume(to_light, a, b);
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
    if (u + v + w == 0) return false;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double along = glm::dot(to_light, normal);
    if (along == 0) return false;
    const double distance = glm::dot(a, normal) / along;
    if (!(distance > 0) || (!directional && !(distance < 1))) return false;
    return receiver.instance == kNoId || !is_neighbour_in_plane(receivers_.get_corners_rel(receiver), corners);
}

bool OcclusionRule::is_own_surface(const PixelIds& receiver, const PixelIds& caster) const {
    if (receiver.instance == caster.instance && receiver.triangle == caster.triangle) return true;
    return is_neighbour_in_plane(receivers_.get_corners_rel(receiver), receivers_.get_corners_rel(caster));
}

double OcclusionRule::find_corner_rounding(const PixelIds& ids) const {
    const Instance& instance = receivers_.scene->instances[ids.instance];
    const Mesh& mesh = *receivers_.scene->meshes[instance.mesh];
    const glm::uvec3& triangle = mesh.triangles[ids.triangle];
    double largest = 0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 size = glm::abs(glm::dvec3(mesh.positions[triangle[k]]));
        for (int axis = 0; axis < 3; ++axis)
            largest = std::max(largest, glm::length(glm::dvec3(instance.world_from_object[axis])) * size[axis]);
    }
    return kCornerRounding * largest;
}

bool lies_in_plane(const glm::dvec3& point, const glm::dvec3& unit_normal, const std::array<glm::dvec3, 3>& corners,
                   double rounding) {
    for (const glm::dvec3& corner : corners) {
        const glm::dvec3 offset = corner - point;
        if (!(std::abs(glm::dot(unit_normal, offset)) <= kFlatTolerance * glm::length(offset) + rounding)) return false;
    }
    return true;
}

}  // namespace shadow_layers
