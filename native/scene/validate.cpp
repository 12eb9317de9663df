// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>
#include <sstream>

#include "shadow_layers/camera.h"
#include "shadow_layers/error.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

namespace {

/// Largest entry of a matrix: products of two stay far from what a float can hold.
constexpr double kLargestEntry = 1e15;
/// A spot's cone may be so many times wider along one axis than along another.
constexpr double kLeastSpotScale = 1e-6;
/// How far axes may be from unit length and right angles. Blender's matrices are float32.
constexpr double kAxisTolerance = 1e-3;

std::string text_of(double value) {
    std::ostringstream text;
    text.precision(9);
    text << value;
    return text.str();
}

[[noreturn]] void refuse(const std::string& who, const std::string& what) { throw InputError(who + ": " + what); }

void check_range(const std::string& who, const char* field, double value, double min, double max, const char* remedy) {
    if (value >= min && value <= max) return;  // false for NaN
    refuse(who, std::string(field) + " is " + text_of(value) + "; it must be from " + text_of(min) + " to " +
                    text_of(max) + (*remedy ? std::string(": ") + remedy : std::string()));
}

/// Row and column as written on paper (and in NumPy).
void check_matrix(const std::string& who, const char* field, const glm::dmat4& matrix) {
    const auto entry = [&](int row, int column) {
        return std::string(field) + "[" + std::to_string(row) + "][" + std::to_string(column) + "] is " +
               text_of(matrix[column][row]);
    };
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            const double value = matrix[column][row];
            if (!std::isfinite(value)) refuse(who, entry(row, column) + "; every entry must be a finite number");
            if (std::abs(value) > kLargestEntry)
                refuse(who, entry(row, column) + "; entries beyond " + text_of(kLargestEntry) +
                                " cannot be rendered: scale the scene down or move it nearer to the origin");
        }
    for (int column = 0; column < 4; ++column)
        if (matrix[column][3] != (column == 3 ? 1.0 : 0.0))
            refuse(who, entry(3, column) + "; the last row must be 0 0 0 1 (an affine matrix, not a projection)");
}

void check_axes(const std::string& who, const char* field, const glm::dmat4& matrix, const char* remedy) {
    static const char* const kNames[3] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
        const double length = glm::length(glm::dvec3(matrix[i]));
        if (std::abs(length - 1) > kAxisTolerance)
            refuse(who, std::string("the ") + kNames[i] + " axis of " + field + " has length " + text_of(length) +
                            "; it must be 1: " + remedy);
        const int j = (i + 1) % 3;
        const double cosine = glm::dot(glm::dvec3(matrix[i]), glm::dvec3(matrix[j]));
        if (std::abs(cosine) > kAxisTolerance)
            refuse(who, std::string("the ") + kNames[i] + " and " + kNames[j] + " axes of " + field +
                            " are not at right angles (cosine " + text_of(cosine) + "): " + remedy);
    }
}

void check_group(const std::string& who, const char* field, unsigned group) {
    if (group > 63) refuse(who, std::string(field) + " is " + std::to_string(group) + "; groups are numbered 0 to 63");
}

void check_instance(const Scene& scene, std::size_t index) {
    const Instance& instance = scene.instances[index];
    std::string who = "instance " + std::to_string(index);
    if (instance.mesh >= scene.meshes.size())
        refuse(who, "mesh is " + std::to_string(instance.mesh) + ", but the scene has " +
                        std::to_string(scene.meshes.size()) + " meshes: add the mesh before its instances");
    who += " (mesh \"" + scene.meshes[instance.mesh]->name + "\")";
    check_matrix(who, "world_from_object", instance.world_from_object);
    check_group(who, "receiver_group", instance.receiver_group);
    check_group(who, "blocker_group", instance.blocker_group);
}

void check_light(const Light& light, std::size_t index) {
    const std::string who = "light " + std::to_string(index) + " (\"" + light.name + "\")";
    if (light.kind > LightKind::Area) refuse(who, "kind is not one of sun, spot, point and area");
    check_matrix(who, "world_from_light", light.world_from_light);
    check_axes(who, "world_from_light", light.world_from_light,
               "take the scale out of the matrix (an area light's size goes to area_size)");
    for (int channel = 0; channel < 3; ++channel)
        check_range(who, "color", light.color[channel], 0, 1e30, "give linear RGB");
    check_range(who, "energy", light.energy, -1e30, 1e30, "");
    check_range(who, "radius", light.radius, 0, kLargestEntry, "");
    check_range(who, "sun_angle", light.sun_angle, 0, std::numbers::pi + 1e-6, "give radians");
    check_range(who, "spot_blend", light.spot_blend, 0, 1, "");
    for (int axis = 0; axis < 2; ++axis)
        check_range(who, "spot_scale", light.spot_scale[axis], kLeastSpotScale, 1 / kLeastSpotScale,
                    "give the light's scale along x and y over that along z");
    check_range(who, "area_size", light.area_size.x, 0, kLargestEntry, "");
    check_range(who, "area_size", light.area_size.y, 0, kLargestEntry, "");
    if (light.kind == LightKind::Spot && !(light.spot_angle > 0 && light.spot_angle <= std::numbers::pi + 1e-6))
        refuse(who, "spot_angle is " + text_of(light.spot_angle) +
                        "; it must be above 0 and at most pi: give the full cone angle in radians");
}

}  // namespace

void validate(const Scene& scene) {
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
        if (!scene.meshes[i]) refuse("mesh " + std::to_string(i), "there is none; make it with make_mesh");
    for (std::size_t i = 0; i < scene.instances.size(); ++i) check_instance(scene, i);
    for (std::size_t i = 0; i < scene.lights.size(); ++i) check_light(scene.lights[i], i);
}

void validate(const Camera& camera) {
    const std::string who = "camera";
    check_matrix(who, "world_from_camera", camera.world_from_camera);
    check_axes(who, "world_from_camera", camera.world_from_camera, "take the scale out of the matrix");
    const CameraWindow& window = camera.window;
    check_range(who, "window.left", window.left, -kLargestEntry, kLargestEntry, "");
    check_range(who, "window.right", window.right, -kLargestEntry, kLargestEntry, "");
    check_range(who, "window.bottom", window.bottom, -kLargestEntry, kLargestEntry, "");
    check_range(who, "window.top", window.top, -kLargestEntry, kLargestEntry, "");
    if (!(window.right > window.left))
        refuse(who,
               "the window is empty: right " + text_of(window.right) + " is not above left " + text_of(window.left));
    if (!(window.top > window.bottom))
        refuse(who,
               "the window is empty: top " + text_of(window.top) + " is not above bottom " + text_of(window.bottom));
    check_range(who, "clip_start", camera.clip_start, -kLargestEntry, kLargestEntry, "");
    check_range(who, "clip_end", camera.clip_end, -kLargestEntry, kLargestEntry, "");
    if (camera.perspective && !(camera.clip_start > 0))
        refuse(who, "clip_start is " + text_of(camera.clip_start) + "; a perspective camera needs one above 0");
    if (!(camera.clip_end > camera.clip_start))
        refuse(who, "clip_end " + text_of(camera.clip_end) + " is not beyond clip_start " + text_of(camera.clip_start));
}

}  // namespace shadow_layers
