// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "shadow_layers/scene.h"

namespace shadow_layers {

/// A vertex that geometry may be made of: finite, and small enough that squares of differences fit a float (|c| <=
/// 1e18). Triangles that use any other vertex are left out everywhere: frame, maps, silhouettes, bounds.
inline bool is_usable_vertex(const glm::vec3& p) {
    constexpr float kLargest = 1e18f;
    return std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest;  // false for NaN
}

/// Bounds of the usable vertices that triangles refer to, object space. Made by make_mesh; kept in Mesh::bounds.
Bounds compute_mesh_bounds(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

/// The box round `bounds` moved by the affine `matrix`; empty stays empty. O(1), not tight for rotated boxes.
Bounds transform_bounds(const Bounds& bounds, const glm::dmat4& matrix);

/// World bounds of an instance, and of all instances whose flags meet any of `flags`.
Bounds compute_instance_bounds(const Scene& scene, const Instance& instance);
Bounds compute_scene_bounds(const Scene& scene, std::uint32_t flags = kInstanceCamera | kInstanceShadow);

/// Corner k of a box: bit 0, 1, 2 of k choose max over min in x, y, z.
inline glm::dvec3 box_corner(const Bounds& bounds, int k) {
    return {k & 1 ? bounds.max.x : bounds.min.x, k & 2 ? bounds.max.y : bounds.min.y,
            k & 4 ? bounds.max.z : bounds.min.z};
}

}  // namespace shadow_layers
