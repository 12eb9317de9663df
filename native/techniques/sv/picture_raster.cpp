// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/sv/picture_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shadow_layers {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Boxes are wider than polygons by what rounding may cost: pixels near the picture are known to 1e-9 of one.
constexpr double kBoxMarginPx = 1e-3;
// Of a sum's terms: below, its sign is not believed.
constexpr double kSignError = 1e-9;

/// First pixel of the row whose centre does not lie before `x`.
int first_pixel_from(double x, PixelSpan within) {
    return int(std::ceil(std::clamp(x - 0.5, double(within.begin), double(within.end))));
}

void empty(PixelSpan& span) { span.end = span.begin; }

PixelSpan to_span(double low, double high, int size) {
    const double first = std::clamp(std::floor(low - 0.5 - kBoxMarginPx), 0.0, double(size));
    const double last = std::clamp(std::floor(high + 0.5 + kBoxMarginPx), 0.0, double(size));
    return {int(first), int(last)};
}

/// An interval of one coordinate, grown by the polygon's corners and by the sides that run out of sight.
struct Reach {
    double low = kInfinity, high = -kInfinity;

    void add_corner(double xw, double w) {
        low = std::min(low, xw / w);
        high = std::max(high, xw / w);
    }
    /// A side from w > 0 to w <= 0 leaves to the infinity that it has the sign of where w = 0.
    void add_exit(double xw, double w, double other_xw, double other_w) {
        const double sign = w * other_xw - xw * other_w;
        const double error = kSignError * (std::abs(w * other_xw) + std::abs(xw * other_w));
        if (!(sign < -error)) high = kInfinity;
        if (!(sign > error)) low = -kInfinity;
    }
};

}  // namespace

PictureSpace::PictureSpace(const Camera& camera, int width, int height)
    : width_(width), height_(height), perspective_(camera.perspective) {
    const RayBasis rays(camera, width, height);
    eye_ = rays.origin_0;
    // A point is eye + w (x dx + y dy + direction_0), or origin_0 + x dx + y dy + depth direction_0.
    const glm::dmat3 axes = camera.perspective ? glm::dmat3(rays.direction_dx, rays.direction_dy, rays.direction_0)
                                               : glm::dmat3(rays.origin_dx, rays.origin_dy, rays.direction_0);
    pixel_from_rel_ = glm::inverse(axes);
    handedness_ = glm::determinant(axes) < 0 ? -1 : 1;
}

glm::dvec3 PictureSpace::project(const glm::dvec3& point_rel, double w) const {
    const glm::dvec3 place = pixel_from_rel_ * (point_rel - w * eye_);
    return perspective_ ? place : glm::dvec3(place.x, place.y, w);
}

PictureLine PictureLine::make(const glm::dvec3& p, const glm::dvec3& q, bool flip) {
    const glm::dvec3 line = flip ? glm::cross(q, p) : glm::cross(p, q);
    return {line.z, line.x, line.y, flip};
}

RowSpans find_row_spans(std::span<const PictureLine> lines, int row, PixelSpan within) {
    RowSpans spans{within, within};
    const double y = row + 0.5;
    for (const PictureLine& line : lines) {
        const double at_start = line.at_origin + y * line.by_y;
        if (line.by_x == 0) {
            const bool left = at_start != 0 ? at_start > 0 : line.by_y >= 0;
            empty(left != line.reversed ? spans.right : spans.left);
            continue;
        }
        const int split = first_pixel_from(-at_start / line.by_x, within);
        const bool grows = (line.by_x > 0) != line.reversed;
        PixelSpan& from = grows ? spans.left : spans.right;
        PixelSpan& until = grows ? spans.right : spans.left;
        from.begin = std::max(from.begin, split);
        until.end = std::min(until.end, split);
    }
    return spans;
}

bool find_pixel_box(std::span<const glm::dvec3> corners, const PictureSpace& picture, PixelBox& box) {
    Reach x, y;
    bool before = false, at_infinity = true;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3& p = corners[k];
        const glm::dvec3& q = corners[(k + 1) % corners.size()];
        at_infinity = at_infinity && p.z == 0;
        if (p.z > 0) {
            before = true;
            x.add_corner(p.x, p.z);
            y.add_corner(p.y, p.z);
        }
        if ((p.z > 0) == (q.z > 0)) continue;
        const glm::dvec3 &in = p.z > 0 ? p : q, &out = p.z > 0 ? q : p;
        x.add_exit(in.x, in.z, out.x, out.z);
        y.add_exit(in.y, in.z, out.y, out.z);
    }
    if (!before) {
        // All parallel rays meet a cap at infinity, or none.
        if (picture.perspective() || !at_infinity) return false;
        box = {{0, picture.width()}, {0, picture.height()}};
        return true;
    }
    box.columns = to_span(x.low, x.high, picture.width());
    box.rows = to_span(y.low, y.high, picture.height());
    return box.columns.begin < box.columns.end && box.rows.begin < box.rows.end;
}

}  // namespace shadow_layers
