// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "frame/camera_window.h"

namespace shadow_layers {

/// The picture's plane in homogeneous pixel coordinates (x w, y w, w), in double: w > 0 before the camera
/// (perspective), or 1 of points and 0 of directions (orthographic). Nothing is divided, so nothing needs clipping.
class PictureSpace {
public:
    PictureSpace(const Camera& camera, int width, int height);

    /// `point_rel`: a point relative to the frame's origin (w = 1) or a direction (w = 0).
    glm::dvec3 project(const glm::dvec3& point_rel, double w) const;

    /// -1 if the pixel's axes and the view direction are a left-handed frame, else 1.
    int handedness() const { return handedness_; }
    bool perspective() const { return perspective_; }
    int width() const { return width_; }
    int height() const { return height_; }

private:
    glm::dmat3 pixel_from_rel_;
    glm::dvec3 eye_;  ///< where pixel coordinates start: the camera, or the picture's corner
    int handedness_ = 1, width_, height_;
    bool perspective_;
};

/// The line through two points of the picture: at_origin + x by_x + y by_y is above 0 on its left side. Every polygon
/// at an edge takes it the same way round (`reversed` tells the others), so that no pixel falls between or counts
/// twice.
struct PictureLine {
    double at_origin = 0, by_x = 0, by_y = 0;
    bool reversed = false;

    /// From p to q. `flip`: the line is kept from q to p.
    static PictureLine make(const glm::dvec3& p, const glm::dvec3& q, bool flip);
};

/// Pixels of a row, [begin, end).
struct PixelSpan {
    int begin = 0, end = 0;
};

/// The spans of a row where all lines are on their left, and where all are on their right. A pixel centre on a line is
/// taken as if all pixels lay a touch to the right, and less of a touch up.
struct RowSpans {
    PixelSpan left, right;
};
RowSpans find_row_spans(std::span<const PictureLine> lines, int row, PixelSpan within);

/// A box of pixels that holds all of a polygon's that lie before the camera; false if there are none. Corners are
/// homogeneous, w >= 0 in space.
struct PixelBox {
    PixelSpan columns, rows;
};
bool find_pixel_box(std::span<const glm::dvec3> corners, const PictureSpace& picture, PixelBox& box);

}  // namespace shadow_layers
