// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/light_frame.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lights/light_shape.h"
#include "lights/receiver_scan.h"
#include "lights/view_casters.h"
#include "scene/bounds.h"

namespace shadow_layers {
namespace {

// Spots up to this half angle are worked in one frame: farther from the axis boxes have useless images.
constexpr double kWidestHalfAngle = 50 * std::numbers::pi / 180;

// Enough to know in which direction most edges run.
constexpr std::size_t kSampledInstances = 64, kSampledTriangles = 1 << 14;

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
    const bool is_narrow = light.kind == LightKind::Spot && 0.5 * find_widest_spot_angle(light) <= kWidestHalfAngle;
    if (light.kind == LightKind::Sun || light.kind == LightKind::Area || is_narrow) return {frame};
    std::vector<LightFrame> faces;
    for (int face = 0; face < 6; ++face) {
        frame.axes = compute_face_axes(centre.axes_ws, face);
        frame.face = face;
        faces.push_back(frame);
    }
    return faces;
}

void align_with_edges(const Scene& scene, const Light& light, LightFrame& frame) {
    // The mean of edges' directions modulo a quarter turn, as complex numbers to the fourth power. An edge counts by
    // its squared length.
    glm::dvec2 sum(0.0);
    const std::size_t instance_step = std::max<std::size_t>(1, scene.instances.size() / kSampledInstances);
    for (std::size_t i = 0; i < scene.instances.size(); i += instance_step) {
        const Instance& instance = scene.instances[i];
        const Mesh& mesh = *scene.meshes[instance.mesh];
        if (!casts_for(light, instance)) continue;
        const glm::dmat3 turned = glm::transpose(frame.axes) * glm::dmat3(instance.world_from_object);
        const std::size_t step =
            std::max<std::size_t>(1, mesh.triangles.size() * kSampledInstances / kSampledTriangles);
        for (std::size_t t = 0; t < mesh.triangles.size(); t += step) {
            const glm::uvec3& triangle = mesh.triangles[t];
            for (int k = 0; k < 3; ++k) {
                const glm::vec3 &p = mesh.positions[triangle[k]], &q = mesh.positions[triangle[(k + 1) % 3]];
                if (!is_usable_vertex(p) || !is_usable_vertex(q)) continue;
                const glm::dvec2 edge(turned * (glm::dvec3(q) - glm::dvec3(p)));
                const double squared = glm::dot(edge, edge);
                if (!(squared > 0)) continue;
                const glm::dvec2 once = edge / std::sqrt(squared);
                const glm::dvec2 twice(once.x * once.x - once.y * once.y, 2 * once.x * once.y);
                sum +=
                    squared * double(step) * glm::dvec2(twice.x * twice.x - twice.y * twice.y, 2 * twice.x * twice.y);
            }
        }
    }
    if (sum == glm::dvec2(0.0)) return;
    const double angle = 0.25 * std::atan2(sum.y, sum.x), c = std::cos(angle), s = std::sin(angle);
    const glm::dmat3 axes = frame.axes;
    frame.axes[0] = c * axes[0] + s * axes[1];
    frame.axes[1] = c * axes[1] - s * axes[0];
}

}  // namespace shadow_layers
