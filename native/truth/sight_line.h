// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

namespace shadow_layers::truth {

using Corners = std::array<glm::dvec3, 3>;

/// From a start (a receiver, the camera) to its end (a light), or on without end.
struct SightLine {
    glm::dvec3 start{0.0}, way{0.0};  ///< the end is start + way
    bool endless = false;             ///< a sun: there is no end, `way` is a direction
    double slack = 0;  ///< scene units: how far start, end and corners may be off, in this program or in another
};

/// How a line and a triangle meet. `certain`: no rounding of double arithmetic changes the answer, here or in another
/// program that computes it by another formula, as long as its places are right to the line's slack.
struct Crossing {
    bool meets = false, certain = true;
    double distance = 0;  ///< of the crossing, in lengths of the way
};

/// Does the triangle lie strictly between the two ends of the line? Its rim belongs to it; one that the line sees
/// edge-on, or without area, is not met. Decided by the volumes that the way spans with the edges, each against a bound
/// of its error.
Crossing cross_triangle(const SightLine& line, const Corners& corners);

/// Whether a triangle lies in a plane, as far as its corners' rounding tells: float corners of a flat face lie off its
/// plane by some 1e-7 of their distance. The plane goes through `point`; its normal is a unit vector.
bool lies_in_plane(const Corners& corners, const glm::dvec3& point, const glm::dvec3& normal);

/// A triangle's relation to the receiver's own triangle. The surface of a receiver does not shadow it: not its own
/// triangle, nor one that has two corners in common with it and whose third corner lies in its plane, to 1e-6 of that
/// corner's distance.
struct Neighbourhood {
    bool is_own_surface = false, certain = true;
};

/// `slack`: how far apart places may be that another program takes for one. Uncertain where the third corner is as high
/// as the tolerance, give or take which corner of `self` its distance is measured from.
Neighbourhood find_neighbourhood(const Corners& self, const Corners& other, double slack);

}  // namespace shadow_layers::truth
