// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/sight_line.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shadow_layers::truth {
namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon();
constexpr double kFlat = 1e-6;  // of a corner's distance: how high it may lie over a plane that it belongs to

/// A number and a bound of its error.
struct Bounded {
    double value = 0, error = 0;
    bool is_certain() const { return std::abs(value) > error; }
};

/// How much the volume of three vectors changes when each is moved by up to its own reach.
double find_volume_change(const std::array<glm::dvec3, 3>& vectors, const std::array<double, 3>& reach) {
    double change = reach[0] * reach[1] * reach[2];
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        change += reach[i] * glm::length(glm::cross(vectors[j], vectors[k]));
        change += reach[j] * reach[k] * glm::length(vectors[i]);
    }
    return change;
}

/// The volume that the way spans with the edge from p to q, which are relative to the start.
Bounded find_edge_volume(const SightLine& line, const glm::dvec3& p, const glm::dvec3& q) {
    const glm::dvec3 edge = q - p;
    const double rounding =
        16 * kRounding * glm::length(line.way) * glm::length(p) * (glm::length(q) + glm::length(edge));
    const double moved = 2 * line.slack;  // the start, and the corner or the end
    return {glm::dot(line.way, glm::cross(p, edge)),
            rounding + find_volume_change({line.way, p, q}, {line.endless ? 0 : moved, moved, moved})};
}

/// The height of a vector, which is off by up to `reach`, over the triangle's plane, times twice its area.
Bounded find_height(const glm::dvec3& vector, double reach, const glm::dvec3& e, const glm::dvec3& f, double slack) {
    const double rounding = 16 * kRounding * glm::length(vector) * glm::length(e) * glm::length(f);
    return {glm::dot(vector, glm::cross(e, f)),
            rounding + find_volume_change({vector, e, f}, {reach, 2 * slack, 2 * slack})};
}

/// Do the edges lie on both sides of the line, beyond doubt? Quick, and says no where the bound is not that sharp.
bool passes_wide(const SightLine& line, const std::array<glm::dvec3, 3>& corners) {
    const double way = glm::length(line.way), moved = 2 * line.slack;
    const double far = std::max({glm::length(corners[0]), glm::length(corners[1]), glm::length(corners[2])}) + moved;
    const double error = 64 * kRounding * way * far * far + 4 * moved * (way + moved) * far + 2 * moved * far * far;
    bool above = false, below = false;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3& next = corners[(i + 1) % 3];
        const double volume = glm::dot(line.way, glm::cross(corners[i], next - corners[i]));
        above = above || volume > error;
        below = below || volume < -error;
    }
    return above && below;
}

}  // namespace

Crossing cross_triangle(const SightLine& line, const Corners& corners) {
    const glm::dvec3 a = corners[0] - line.start, b = corners[1] - line.start, c = corners[2] - line.start;
    if (passes_wide(line, {a, b, c})) return {};
    bool above = false, below = false, all_certain = true;
    for (const Bounded& volume :
         {find_edge_volume(line, a, b), find_edge_volume(line, b, c), find_edge_volume(line, c, a)}) {
        if (volume.is_certain())
            (volume.value > 0 ? above : below) = true;
        else
            all_certain = false;
    }
    if (above && below) return {};
    const glm::dvec3 e = b - a, f = c - a;
    const double moved = 2 * line.slack;
    const Bounded rise = find_height(line.way, line.endless ? 0 : moved, e, f, line.slack);
    const Bounded start = find_height(a, moved, e, f, line.slack),
                  end = find_height(a - line.way, moved, e, f, line.slack);
    // In the direction of the way: the plane's distance and the rest of the way, both times the same positive number.
    const double sign = rise.value > 0 ? 1 : -1;
    const Bounded before{sign * start.value, start.error}, after{-sign * end.value, end.error};
    const auto misses = [](const Bounded& part) { return part.is_certain() && part.value < 0; };
    if (rise.is_certain() && (misses(before) || (!line.endless && misses(after)))) return {};
    Crossing crossing;
    crossing.certain = all_certain && rise.is_certain() && before.is_certain() && (line.endless || after.is_certain());
    // A rim that can't be told from the line belongs to the triangle: between two triangles there is no crack.
    crossing.meets = rise.is_certain() && before.value > 0 && (line.endless || after.value > 0);
    if (rise.value != 0) crossing.distance = start.value / rise.value;
    return crossing;
}

bool lies_in_plane(const Corners& corners, const glm::dvec3& point, const glm::dvec3& normal) {
    double height = 0, reach = 0;
    for (const glm::dvec3& corner : corners) {
        height = std::max(height, std::abs(glm::dot(normal, corner - point)));
        reach = std::max(reach, glm::length(corner - point));
    }
    return height <= kFlat * reach;
}

Neighbourhood find_neighbourhood(const Corners& self, const Corners& other, double slack) {
    int shared = 0, nearly = 0;
    glm::dvec3 apex = other[0];
    for (const glm::dvec3& place : other) {
        const bool same = std::find(self.begin(), self.end(), place) != self.end();
        const bool near = std::any_of(self.begin(), self.end(),
                                      [&](const glm::dvec3& own) { return glm::length(own - place) <= slack; });
        if (same)
            ++shared;
        else if (near)
            ++nearly;
        else
            apex = place;
    }
    if (shared + nearly < 2) return {};
    if (shared + nearly == 3) return {true, nearly == 0};
    const glm::dvec3 normal = glm::cross(self[1] - self[0], self[2] - self[0]);
    const double height = std::abs(glm::dot(normal, apex - self[0])) / glm::length(normal);
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
    for (const glm::dvec3& own : self) {
        nearest = std::min(nearest, glm::length(apex - own));
        farthest = std::max(farthest, glm::length(apex - own));
    }
    const bool is_flat = height <= kFlat * farthest;
    const bool is_tolerance =
        height > 0.99 * kFlat * nearest - 4 * slack && height < 1.01 * kFlat * farthest + 4 * slack;
    return {is_flat, !is_flat || (nearly == 0 && !is_tolerance)};
}

}  // namespace shadow_layers::truth
