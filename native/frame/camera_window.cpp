// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/camera_window.h"

namespace shadow_layers {

Camera crop_camera(const Camera& camera, int width, int height, const PixelRect& region, int overscan_px,
                   const glm::dvec2& offset_px) {
    const CameraWindow& full = camera.window;
    const double pixel_x = (full.right - full.left) / width;
    const double pixel_y = (full.top - full.bottom) / height;
    Camera cropped = camera;
    cropped.window.left = full.left + pixel_x * (region.x - overscan_px + offset_px.x);
    cropped.window.right = full.left + pixel_x * (region.x + region.width + overscan_px + offset_px.x);
    cropped.window.bottom = full.bottom + pixel_y * (region.y - overscan_px + offset_px.y);
    cropped.window.top = full.bottom + pixel_y * (region.y + region.height + overscan_px + offset_px.y);
    return cropped;
}

glm::dmat4 camera_from_world(const Camera& camera) {
    const glm::dmat3 axes = glm::transpose(glm::dmat3(camera.world_from_camera));
    glm::dmat4 matrix(axes);
    matrix[3] = glm::dvec4(-(axes * glm::dvec3(camera.world_from_camera[3])), 1.0);
    return matrix;
}

glm::dmat4 clip_from_camera(const Camera& camera, double near_vs, double far_vs) {
    const CameraWindow& w = camera.window;
    const double width = w.right - w.left, height = w.top - w.bottom, range = far_vs - near_vs;
    glm::dmat4 clip(0.0);
    clip[0][0] = 2.0 / width;
    clip[1][1] = 2.0 / height;
    if (camera.perspective) {
        // z_clip = near (far + z) / (far - near), w_clip = -z: their ratio is 1 at z = -near and 0 at z = -far.
        clip[2] = glm::dvec4((w.left + w.right) / width, (w.bottom + w.top) / height, near_vs / range, -1.0);
        clip[3] = glm::dvec4(0.0, 0.0, near_vs * (far_vs / range), 0.0);
    } else {
        clip[2] = glm::dvec4(0.0, 0.0, 1.0 / range, 0.0);
        clip[3] = glm::dvec4(-(w.left + w.right) / width, -(w.bottom + w.top) / height, far_vs / range, 1.0);
    }
    return clip;
}

RayBasis::RayBasis(const Camera& camera, int width, int height) {
    const CameraWindow& w = camera.window;
    const glm::dmat3 axes(camera.world_from_camera);
    const glm::dvec3 corner = axes[0] * w.left + axes[1] * w.bottom;
    const glm::dvec3 dx = axes[0] * ((w.right - w.left) / width);
    const glm::dvec3 dy = axes[1] * ((w.top - w.bottom) / height);
    const glm::dvec3 zero(0.0);
    origin_0 = camera.perspective ? zero : corner;
    origin_dx = camera.perspective ? zero : dx;
    origin_dy = camera.perspective ? zero : dy;
    direction_0 = camera.perspective ? corner - axes[2] : -axes[2];
    direction_dx = camera.perspective ? dx : zero;
    direction_dy = camera.perspective ? dy : zero;
}

}  // namespace shadow_layers
