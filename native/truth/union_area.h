// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace shadow_layers::truth {

/// A convex polygon in the plane, its corners in order, either way round.
class ConvexPolygon {
public:
    static constexpr int kMostCorners = 20;  ///< of those given to compute_union_area: four less

    void add(const glm::dvec2& corner) { corners_.at(std::size_t(size_++)) = corner; }
    int size() const { return size_; }
    const glm::dvec2& corner(int i) const { return corners_[std::size_t(i % size_)]; }

    /// The part where dot(normal, p) <= bound; the corners on the line are kept. One corner more at most.
    ConvexPolygon clip(const glm::dvec2& normal, double bound) const;
    double compute_area() const;

private:
    std::array<glm::dvec2, kMostCorners> corners_;
    int size_ = 0;
};

/// A rectangle with its sides along the axes.
struct Rectangle {
    glm::dvec2 low{-0.5}, high{0.5};
    double area() const { return (high.x - low.x) * (high.y - low.y); }
};

/// The area that the polygons cover together inside of the rectangle: exact but for rounding, some 1e-15 of its area
/// for each polygon. Polygons may touch, overlap, repeat, and have no area.
///
/// Between two neighbours among the heights of all corners and crossings no two sides cross, so that the covered length
/// along a line is linear there: its value in the middle times the strip's height is the strip's area. A wrong height
/// by rounding misplaces an area of its own order only. Where there are many polygons, the rectangle is quartered
/// first.
double compute_union_area(std::span<const ConvexPolygon> polygons, const Rectangle& within);

}  // namespace shadow_layers::truth
