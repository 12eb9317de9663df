// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/fsasm/facet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/receivers.h"

namespace shadow_layers {
namespace {

// As in visibility/occlusion_rule.h: a position that the frame holds elsewhere than on the plane.
constexpr double kPlaceTolerance = 1e-5;
// Texels by which a footprint is widened, far more than double rounds.
constexpr double kRectMargin = 1e-6;

/// Cuts a convex polygon at the half-space dot(plane, corner) >= 0; returns the number of corners left.
int cut_polygon(glm::dvec4* corners, int count, const glm::dvec4& plane) {
    constexpr int kMost = 12;
    glm::dvec4 kept[kMost];
    int kept_count = 0;
    for (int i = 0; i < count; ++i) {
        const glm::dvec4 &from = corners[i], &to = corners[(i + 1) % count];
        const double at_from = glm::dot(plane, from), at_to = glm::dot(plane, to);
        if (at_from >= 0) kept[kept_count++] = from;
        if ((at_from >= 0) != (at_to >= 0) && kept_count < kMost)
            kept[kept_count++] = from + (at_from / (at_from - at_to)) * (to - from);
    }
    std::copy(kept, kept + kept_count, corners);
    return kept_count;
}

int cut_at_rim(glm::dvec4* corners, int count) {
    for (int axis = 0; axis < 2; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            glm::dvec4 plane(0, 0, 0, 1);
            plane[axis] = sign;
            count = cut_polygon(corners, count, plane);
        }
    return count;
}

void set_range(double low, double high, int side, int& begin, int& end) {
    begin = int(std::clamp(std::floor(low - kRectMargin), 0.0, double(side)));
    end = int(std::clamp(std::floor(high + kRectMargin) + 1, 0.0, double(side)));
}

}  // namespace

FacetMaker::FacetMaker(const Frame& frame) : frame_(frame), rays_(frame.camera, frame.width, frame.height) {}

std::optional<FacetMaker::Facet> FacetMaker::make(std::size_t pixel) const {
    const TrianglePlane plane = compute_triangle_plane(*frame_.scene, frame_.ids[pixel], frame_.camera);
    const double x = double(pixel % std::size_t(frame_.width)) + 0.5;
    const double y = double(pixel / std::size_t(frame_.width)) + 0.5;
    const glm::dvec3 origin = rays_.origin_at(x, y), direction = rays_.direction_at(x, y);
    const glm::dvec3& n = plane.normal;
    const double along = glm::dot(n, direction), above = plane.distance - glm::dot(n, origin);
    if (!(std::abs(along) > 0)) return std::nullopt;
    const glm::dvec3 found = origin + direction * (above / along), held(frame_.positions_rel[pixel]);
    if (!(glm::length(found - held) <= kPlaceTolerance * (glm::length(held) + glm::length(origin))))
        return std::nullopt;
    // The ray o + d t meets the plane at t = above / along, so o along + d above is its homogeneous place. Of o and d
    // one is the same for all rays (perspective, orthographic), so the place is linear in x and y.
    const auto derive = [&](const glm::dvec3& origin_by, const glm::dvec3& direction_by) {
        const double along_by = glm::dot(n, direction_by), above_by = -glm::dot(n, origin_by);
        return glm::dvec4(origin_by * along + origin * along_by + direction_by * above + direction * above_by,
                          along_by);
    };
    const double scale = 1 / along;
    return Facet{{glm::dvec4(found, 1), derive(rays_.origin_dx, rays_.direction_dx) * scale,
                  derive(rays_.origin_dy, rays_.direction_dy) * scale},
                 n};
}

double find_radius(const SquareForm& facet_rel) {
    if (!(facet_rel.least_w() > 0)) return std::numeric_limits<double>::infinity();
    double radius = 0;
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5}) {
            const glm::dvec4 corner = facet_rel.value(x, y);
            radius = std::max(radius, glm::length(glm::dvec3(corner) / corner.w - glm::dvec3(facet_rel.at)));
        }
    return radius;
}

SampleMask find_in_front(const SquareForm& form, const SamplePlaces& places) {
    if (form.least_w() > 0) return places.all();
    SampleMask mask;
    for (int i = 0; i < places.count; ++i)
        if (form.value(double(places.x[std::size_t(i)]), double(places.y[std::size_t(i)])).w > 0) mask.set(i);
    return mask;
}

SampleMask find_in_view(const SquareForm& facet_lc, const SamplePlaces& places) {
    const auto radius = [&](int i) { return 0.5 * (std::abs(facet_lc.by_x[i]) + std::abs(facet_lc.by_y[i])); };
    const double least_w = facet_lc.at.w - radius(3);
    if (std::abs(facet_lc.at.x) + radius(0) <= least_w && std::abs(facet_lc.at.y) + radius(1) <= least_w)
        return places.all();
    SampleMask mask;
    for (int i = 0; i < places.count; ++i) {
        const glm::dvec4 lc = facet_lc.value(double(places.x[std::size_t(i)]), double(places.y[std::size_t(i)]));
        if (lc.w > 0 && std::abs(lc.x) <= lc.w && std::abs(lc.y) <= lc.w) mask.set(i);
    }
    return mask;
}

Footprint::Footprint(const SquareForm& facet_lc, int side) {
    glm::dvec4 corners[12] = {facet_lc.value(-0.5, -0.5), facet_lc.value(0.5, -0.5), facet_lc.value(0.5, 0.5),
                              facet_lc.value(-0.5, 0.5)};
    int count = 4;
    const auto is_inside = [](const glm::dvec4& c) { return c.w > 0 && std::abs(c.x) <= c.w && std::abs(c.y) <= c.w; };
    if (!std::all_of(corners, corners + 4, is_inside)) count = cut_at_rim(corners, 4);
    glm::dvec2 low(side), high(0.0);
    for (int i = 0; i < count && count_ < kMostCorners; ++i) {
        if (!(corners[i].w > 0)) continue;  // the view's own point, where no receiver lies
        const glm::dvec2 place = (glm::dvec2(corners[i]) / corners[i].w + 1.0) * (0.5 * side);
        corners_[count_++] = place;
        low = glm::min(low, place);
        high = glm::max(high, place);
    }
    if (count_ == 0) return;
    set_range(low.x, high.x, side, rect_.column_begin, rect_.column_end);
    set_range(low.y, high.y, side, rect_.row_begin, rect_.row_end);
}

void Footprint::find_columns(int row, int& begin, int& end) const {
    const double bottom = row - kRectMargin, top = row + 1 + kRectMargin;
    double low = rect_.column_end, high = rect_.column_begin;
    const auto add = [&](double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    };
    for (int i = 0; i < count_; ++i) {
        const glm::dvec2 &from = corners_[i], &to = corners_[(i + 1) % count_];
        if (from.y >= bottom && from.y <= top) add(from.x);
        for (const double y : {bottom, top})
            if ((from.y < y) != (to.y < y)) add(from.x + (to.x - from.x) * ((y - from.y) / (to.y - from.y)));
    }
    begin = end = rect_.column_begin;
    if (low > high) return;
    int first = 0, last = 0;
    set_range(low, high, rect_.column_end, first, last);
    begin = std::max(first, rect_.column_begin);
    end = std::max(begin, last);
}

}  // namespace shadow_layers
