// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "frame/camera_window.h"
#include "frame/frame.h"
#include "lights/light_views.h"
#include "techniques/fsasm/sample_mask.h"

namespace shadow_layers {

/// Homogeneous coordinates that are linear over a pixel's square: value(x, y) = at + x by_x + y by_y, x and y in pixels
/// from its centre, within [-1/2, 1/2].
struct SquareForm {
    glm::dvec4 at{0.0}, by_x{0.0}, by_y{0.0};

    glm::dvec4 value(double x, double y) const { return at + x * by_x + y * by_y; }
    SquareForm transformed(const glm::dmat4& matrix) const { return {matrix * at, matrix * by_x, matrix * by_y}; }
    double least_w() const { return at.w - 0.5 * (std::abs(by_x.w) + std::abs(by_y.w)); }
};

/// A pixel's facet ([Pan09] 3.1): its square on the plane of the triangle that its centre sees. Only where that plane
/// has a place in front of the camera is w > 0; at the centre w is 1.
class FacetMaker {
public:
    /// `frame` must outlive it.
    explicit FacetMaker(const Frame& frame);

    struct Facet {
        SquareForm rel;     ///< in the space "_rel"
        glm::dvec3 normal;  ///< unit, turned to the camera
    };
    /// None if the pixel's ray runs along the plane, so that its position is no point of it.
    std::optional<Facet> make(std::size_t pixel) const;

private:
    const Frame& frame_;
    RayBasis rays_;
};

/// Distance from the facet's centre to the farthest corner; infinite if the plane's horizon cuts the square.
double find_radius(const SquareForm& facet_rel);

/// Samples of a form at which w > 0.
SampleMask find_in_front(const SquareForm& form, const SamplePlaces& places);

/// Samples of a form in the clip space of a view that lie in the view's map.
SampleMask find_in_view(const SquareForm& facet_lc, const SamplePlaces& places);

/// A rectangle of texels, ends left out.
struct TexelRect {
    int column_begin = 0, column_end = 0, row_begin = 0, row_end = 0;
    bool is_empty() const { return column_begin >= column_end || row_begin >= row_end; }
};

/// What a facet covers of a view's map of side x side texels: a convex polygon, cut at the map's rim.
class Footprint {
public:
    Footprint(const SquareForm& facet_lc, int side);

    /// All texels that the polygon touches, and perhaps more. A facet that the view does not hold has none.
    const TexelRect& rect() const { return rect_; }
    /// Columns [begin, end) of the texels that it touches in a row of `rect`.
    void find_columns(int row, int& begin, int& end) const;

private:
    static constexpr int kMostCorners = 10;
    glm::dvec2 corners_[kMostCorners];  ///< in texels
    int count_ = 0;
    TexelRect rect_;
};

}  // namespace shadow_layers
