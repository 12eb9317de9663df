// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/light_frame.h"

#include <cmath>

#include "lights/receiver_scan.h"

namespace shadow_layers {
namespace {

// Spots up to this half angle are worked in one frame: farther from the axis boxes have useless images.
const double kWidestCosine = std::cos(50 * 3.14159265358979323846 / 180);

}  // namespace

glm::dmat4 LightFrame::from_world(const glm::dvec3& picture_origin_ws) const {
    const glm::dmat3 turned = glm::transpose(axes);
    glm::dmat4 matrix(turned);
    matrix[3] = glm::dvec4(-(turned * (picture_origin_ws + origin_rel)), 1);
    return matrix;
}

std::vector<LightFrame> make_light_frames(const Light& light, const LightSample& centre,
                                          const glm::dvec3& picture_origin_ws) {
    LightFrame frame;
    frame.directional = centre.directional;
    frame.axes = centre.axes_ws;
    frame.centre = centre.directional ? glm::dvec3(0.0) : centre.position_ws - picture_origin_ws;
    const bool is_narrow = light.kind == LightKind::Spot && centre.cone_cos >= kWidestCosine;
    if (light.kind == LightKind::Sun || light.kind == LightKind::Area || is_narrow) return {frame};
    std::vector<LightFrame> faces;
    for (int face = 0; face < 6; ++face) {
        frame.axes = compute_face_axes(centre.axes_ws, face);
        frame.face = face;
        faces.push_back(frame);
    }
    return faces;
}

int find_light_face(const LightSample& centre, const glm::dvec3& from_light_ws) {
    const glm::dvec3 direction = from_light_ws * centre.axes_ws, size = glm::abs(direction);
    if (size.x >= size.y && size.x >= size.z) return direction.x >= 0 ? 0 : 1;
    if (size.y >= size.z) return direction.y >= 0 ? 2 : 3;
    return direction.z >= 0 ? 4 : 5;
}

}  // namespace shadow_layers
