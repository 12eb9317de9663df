// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/union_area.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace shadow_layers::truth {
namespace {

// The work in a cell grows with the square of its polygons, or faster. Sides that meet in one point can't be parted by
// quartering, so it ends.
constexpr std::size_t kFewPolygons = 12;
constexpr int kMostQuarterings = 8;

struct Side {
    glm::dvec2 low, high;  // by y
    double x_at(double y) const { return low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y)); }
};

Side make_side(const glm::dvec2& a, const glm::dvec2& b) { return a.y <= b.y ? Side{a, b} : Side{b, a}; }

/// Heights at which the order of the sides along a line may change: of corners, and of crossings.
std::vector<double> find_heights(std::span<const ConvexPolygon> polygons, const Rectangle& within) {
    std::vector<double> heights = {within.low.y, within.high.y};
    std::vector<Side> sides;
    std::vector<std::size_t> ends;
    for (const ConvexPolygon& polygon : polygons) {
        for (int i = 0; i < polygon.size(); ++i) {
            heights.push_back(polygon.corner(i).y);
            sides.push_back(make_side(polygon.corner(i), polygon.corner(i + 1)));
        }
        ends.push_back(sides.size());
    }
    // Sides of one convex polygon don't cross.
    for (std::size_t p = 0, begin = 0; p < ends.size(); begin = ends[p++]) {
        for (std::size_t a = begin; a < ends[p]; ++a) {
            for (std::size_t b = ends[p]; b < sides.size(); ++b) {
                const double low = std::max(sides[a].low.y, sides[b].low.y);
                const double high = std::min(sides[a].high.y, sides[b].high.y);
                if (!(low < high)) continue;
                const double below = sides[a].x_at(low) - sides[b].x_at(low);
                const double above = sides[a].x_at(high) - sides[b].x_at(high);
                if ((below < 0) != (above < 0) && below != above)
                    heights.push_back(low + (high - low) * (below / (below - above)));
            }
        }
    }
    std::sort(heights.begin(), heights.end());
    return heights;
}

/// Where a line at that height passes through the polygon; empty (first >= second) if it doesn't.
std::pair<double, double> find_run(const ConvexPolygon& polygon, double y) {
    std::pair<double, double> run(1, 0);
    bool found = false;
    for (int i = 0; i < polygon.size(); ++i) {
        const Side side = make_side(polygon.corner(i), polygon.corner(i + 1));
        if (!(side.low.y < y && y < side.high.y)) continue;
        const double x = side.x_at(y);
        run = found ? std::pair(std::min(run.first, x), std::max(run.second, x)) : std::pair(x, x);
        found = true;
    }
    return run;
}

double measure_line(std::span<const ConvexPolygon> polygons, double y, std::vector<std::pair<double, double>>& runs) {
    runs.clear();
    for (const ConvexPolygon& polygon : polygons) {
        const auto run = find_run(polygon, y);
        if (run.first < run.second) runs.push_back(run);
    }
    std::sort(runs.begin(), runs.end());
    double covered = 0, end_so_far = -HUGE_VAL;
    for (const auto& [begin, end] : runs) {
        if (end <= end_so_far) continue;
        covered += end - std::max(begin, end_so_far);
        end_so_far = end;
    }
    return covered;
}

ConvexPolygon clip_to(const ConvexPolygon& polygon, const Rectangle& within) {
    return polygon.clip({1, 0}, within.high.x)
        .clip({-1, 0}, -within.low.x)
        .clip({0, 1}, within.high.y)
        .clip({0, -1}, -within.low.y);
}

double measure_strips(std::span<const ConvexPolygon> polygons, const Rectangle& within) {
    const std::vector<double> heights = find_heights(polygons, within);
    std::vector<std::pair<double, double>> runs;
    double area = 0;
    for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
        const double low = std::max(heights[i], within.low.y), high = std::min(heights[i + 1], within.high.y);
        if (low < high) area += (high - low) * measure_line(polygons, 0.5 * (low + high), runs);
    }
    return std::min(area, within.area());
}

double measure(std::span<const ConvexPolygon> polygons, const Rectangle& within, int quarterings) {
    std::vector<ConvexPolygon> inside, whole;
    for (const ConvexPolygon& polygon : polygons) {
        const ConvexPolygon part = clip_to(polygon, within);
        const double area = part.compute_area();
        if (!(area > 0)) continue;
        // By rounding a whole square's area may lack a little; what is then missing is found no better in strips.
        if (area >= within.area() * (1 - 1e-15)) return within.area();
        inside.push_back(part);
        whole.push_back(polygon);
    }
    if (inside.empty()) return 0;
    if (inside.size() == 1) return inside.front().compute_area();
    if (inside.size() <= kFewPolygons || quarterings == 0) return measure_strips(inside, within);
    const glm::dvec2 middle = 0.5 * (within.low + within.high);
    double area = 0;
    for (const bool right : {false, true}) {
        for (const bool upper : {false, true}) {
            const Rectangle quarter{{right ? middle.x : within.low.x, upper ? middle.y : within.low.y},
                                    {right ? within.high.x : middle.x, upper ? within.high.y : middle.y}};
            area += measure(whole, quarter, quarterings - 1);
        }
    }
    return area;
}

}  // namespace

ConvexPolygon ConvexPolygon::clip(const glm::dvec2& normal, double bound) const {
    ConvexPolygon part;
    for (int i = 0; i < size_; ++i) {
        const glm::dvec2 &here = corner(i), &next = corner(i + 1);
        const double at = glm::dot(normal, here) - bound, then = glm::dot(normal, next) - bound;
        if (at <= 0) part.add(here);
        if ((at < 0 && then > 0) || (at > 0 && then < 0)) part.add(here + (next - here) * (at / (at - then)));
    }
    return part;
}

double ConvexPolygon::compute_area() const {
    double twice = 0;
    for (int i = 2; i < size_; ++i) {
        const glm::dvec2 a = corner(i - 1) - corner(0), b = corner(i) - corner(0);
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * std::abs(twice);
}

double compute_union_area(std::span<const ConvexPolygon> polygons, const Rectangle& within) {
    return measure(polygons, within, kMostQuarterings);
}

}  // namespace shadow_layers::truth
