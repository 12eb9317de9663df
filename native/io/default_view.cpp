// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/default_view.h"

#include <cmath>
#include <limits>

namespace shadow_layers::io {
namespace {

constexpr double kDefaultFieldOfView = 0.7;  // radians, the smaller side's; about 40 degrees
constexpr double kDefaultSunEnergy = 3.0;    // W/m2, bright enough for the clay picture

bool is_finite(const glm::dvec3& point) {
    return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

}  // namespace

WorldBounds compute_world_bounds(const Scene& scene) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    WorldBounds bounds;
    bounds.low = glm::dvec3(kInfinity);
    bounds.high = glm::dvec3(-kInfinity);
    for (const Instance& instance : scene.instances) {
        for (const glm::vec3& position : scene.meshes[instance.mesh]->positions) {
            const glm::dvec3 point(instance.world_from_object * glm::dvec4(position, 1.0));
            if (!is_finite(point)) continue;
            bounds.low = glm::min(bounds.low, point);
            bounds.high = glm::max(bounds.high, point);
            bounds.empty = false;
        }
    }
    if (bounds.empty) bounds = {};
    return bounds;
}

bool make_rigid(glm::dmat4& matrix) {
    glm::dvec3 y(matrix[1]), z(matrix[2]);
    const double z_length = glm::length(z);
    if (!(z_length > 0) || !std::isfinite(z_length)) return false;
    z /= z_length;
    y -= z * glm::dot(y, z);
    const double y_length = glm::length(y);
    if (!(y_length > 1e-12 * glm::length(glm::dvec3(matrix[1]))) || !std::isfinite(y_length)) return false;
    y /= y_length;
    matrix = glm::dmat4(glm::dvec4(glm::cross(y, z), 0), glm::dvec4(y, 0), glm::dvec4(z, 0),
                        glm::dvec4(glm::dvec3(matrix[3]), 1));
    return is_finite(glm::dvec3(matrix[3]));
}

glm::dmat4 look_at(const glm::dvec3& eye, const glm::dvec3& target) {
    const glm::dvec3 z = glm::normalize(eye - target);
    const glm::dvec3 up = std::abs(z.y) < 0.999 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 x = glm::normalize(glm::cross(up, z));
    return glm::dmat4(glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(eye, 1));
}

void add_default_camera(SceneFile& file) {
    const WorldBounds bounds = compute_world_bounds(*file.scene);
    const double radius = bounds.radius() > 0 ? bounds.radius() : 1.0;
    const double half_tan = std::tan(0.5 * kDefaultFieldOfView);
    const double distance = radius / std::sin(0.5 * kDefaultFieldOfView);
    const double wide = std::max(1.0, double(file.width) / file.height),
                 high = std::max(1.0, double(file.height) / file.width);
    file.camera.perspective = true;
    file.camera.window = {-half_tan * wide, half_tan * wide, -half_tan * high, half_tan * high};
    file.camera.world_from_camera =
        look_at(bounds.centre() + distance * glm::normalize(glm::dvec3(0.6, 0.5, 1.0)), bounds.centre());
    file.camera.clip_start = 0.01 * distance;
    file.camera.clip_end = 2.0 * (distance + radius);
    file.warnings.push_back("the file has no camera: one that frames everything was added");
}

void add_default_light(SceneFile& file) {
    const WorldBounds bounds = compute_world_bounds(*file.scene);
    Light sun;
    sun.name = "Default Sun";
    sun.kind = LightKind::Sun;
    sun.energy = kDefaultSunEnergy;
    sun.world_from_light = look_at(bounds.centre() + glm::dvec3(-0.5, 1.0, 0.7), bounds.centre());
    file.scene->lights.push_back(std::move(sun));
    file.warnings.push_back("the file has no light: a sun from the upper left was added");
}

}  // namespace shadow_layers::io
