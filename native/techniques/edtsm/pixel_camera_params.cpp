// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/edtsm/pixel_camera_params.h"

#include "frame/camera_window.h"

namespace shadow_layers {

PixelCamera make_pixel_camera(const Frame& frame) {
    const RayBasis basis(frame.camera, frame.width, frame.height);
    PixelCamera camera{};
    camera.forward = glm::vec4(-glm::vec3(frame.camera.world_from_camera[2]), frame.camera.perspective ? 1.0f : 0.0f);
    camera.origin_dx = glm::vec4(glm::vec3(basis.origin_dx), 0.0f);
    camera.origin_dy = glm::vec4(glm::vec3(basis.origin_dy), 0.0f);
    camera.direction_dx = glm::vec4(glm::vec3(basis.direction_dx), 0.0f);
    camera.direction_dy = glm::vec4(glm::vec3(basis.direction_dy), 0.0f);
    return camera;
}

}  // namespace shadow_layers
