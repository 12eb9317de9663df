// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "shadow_layers/camera.h"

namespace shadow_layers {

/// The camera of a part of the picture: `region` grown by `overscan_px` on each side and moved by `offset_px`.
/// `width` and `height` are the full picture's. Exact in double: only the window moves.
Camera crop_camera(const Camera& camera, int width, int height, const PixelRect& region, int overscan_px,
                   const glm::dvec2& offset_px = glm::dvec2(0.0));

/// Affine map from world to camera space; the camera's axes are orthonormal, so it is a transposition.
glm::dmat4 camera_from_world(const Camera& camera);

/// Reversed depth: 1 at near_vs, 0 at far_vs (both along -Z), GL_ZERO_TO_ONE.
glm::dmat4 clip_from_camera(const Camera& camera, double near_vs, double far_vs);

/// Rays of a window of width x height pixels, camera axes in world space, origin at the camera. The direction has unit
/// length along the view axis, so that a ray's parameter is the view depth, perspective or not.
struct RayBasis {
    glm::dvec3 origin_0, origin_dx, origin_dy;           ///< origin_rel, linear in the place
    glm::dvec3 direction_0, direction_dx, direction_dy;  ///< likewise; x, y in pixels
    RayBasis(const Camera& camera, int width, int height);

    glm::dvec3 origin_at(double x_px, double y_px) const { return origin_0 + x_px * origin_dx + y_px * origin_dy; }
    glm::dvec3 direction_at(double x_px, double y_px) const {
        return direction_0 + x_px * direction_dx + y_px * direction_dy;
    }
};

}  // namespace shadow_layers
