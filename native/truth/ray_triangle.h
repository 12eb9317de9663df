// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

namespace shadow_layers::truth {

using Corners = std::array<glm::dvec3, 3>;

/// Distance along the direction, in its own length, at which the line meets the triangle; its rim counts. The sign of
/// an edge's volume is the same for both triangles at the edge, because the corners are always taken in the same order.
std::optional<double> intersect_triangle(const glm::dvec3& origin, const glm::dvec3& direction, const Corners& corners);

/// Whether a triangle lies in a plane, as far as its corners' rounding tells: float corners of a flat face lie off its
/// plane by some 1e-7 of their distance. The plane goes through `point`; its normal is a unit vector.
bool lies_in_plane(const Corners& corners, const glm::dvec3& point, const glm::dvec3& normal);

/// The same triangle, or one that shares an edge with it and lies in its plane.
bool is_neighbour_in_plane(const Corners& self, const Corners& other);

}  // namespace shadow_layers::truth
