// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/ray_triangle.h"

#include <algorithm>
#include <cmath>

namespace shadow_layers::truth {
namespace {

constexpr double kInPlane = 1e-6;

}  // namespace

std::optional<double> intersect_triangle(const glm::dvec3& origin, const glm::dvec3& direction,
                                         const Corners& corners) {
    const glm::dvec3 a = corners[0] - origin, b = corners[1] - origin, c = corners[2] - origin;
    const auto volume = [&](const glm::dvec3& p, const glm::dvec3& q) {
        const bool swap = p.x != q.x ? p.x > q.x : p.y != q.y ? p.y > q.y : p.z > q.z;
        return swap ? -glm::dot(direction, glm::cross(q, p)) : glm::dot(direction, glm::cross(p, q));
    };
    const double u = volume(b, c), v = volume(c, a), w = volume(a, b);
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
    const double sum = u + v + w;
    if (sum == 0) return std::nullopt;  // edge-on, or without area
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double along = glm::dot(direction, normal);
    if (along == 0) return std::nullopt;
    return glm::dot(a, normal) / along;
}

bool lies_in_plane(const Corners& corners, const glm::dvec3& point, const glm::dvec3& normal) {
    double height = 0, reach = 0;
    for (const glm::dvec3& corner : corners) {
        height = std::max(height, std::abs(glm::dot(normal, corner - point)));
        reach = std::max(reach, glm::length(corner - point));
    }
    return height <= kInPlane * reach;
}

bool is_neighbour_in_plane(const Corners& self, const Corners& other) {
    int shared = 0;
    glm::dvec3 apex = other[0];
    for (const glm::dvec3& p : other) {
        if (p == self[0] || p == self[1] || p == self[2])
            ++shared;
        else
            apex = p;
    }
    if (shared == 3) return true;
    if (shared < 2) return false;
    const glm::dvec3 normal = glm::cross(self[1] - self[0], self[2] - self[0]);
    const glm::dvec3 reach = apex - self[0];
    return std::abs(glm::dot(normal, reach)) <= kInPlane * glm::length(normal) * glm::length(reach);
}

}  // namespace shadow_layers::truth
