// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Small scenes for the tests and benchmarks of techniques, made in code.

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "shadow_layers/camera.h"
#include "shadow_layers/scene.h"

namespace shadow_layers::testing {

struct MeshData {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
};

inline std::shared_ptr<const Mesh> to_mesh(std::string name, MeshData data) {
    auto owner = std::make_shared<const MeshData>(std::move(data));
    return make_mesh(std::move(name), owner->positions, owner->triangles, owner);
}

/// A grid of cells x cells in the plane z = 0, facing +Z.
inline MeshData make_plane(float size, int cells = 1) {
    MeshData data;
    for (int y = 0; y <= cells; ++y)
        for (int x = 0; x <= cells; ++x)
            data.positions.push_back(glm::vec3(float(x) / float(cells) - 0.5f, float(y) / float(cells) - 0.5f, 0) *
                                     size);
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x) {
            const auto at = [&](int i, int j) { return std::uint32_t((y + j) * (cells + 1) + x + i); };
            data.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
            data.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
        }
    return data;
}

/// A box whose edges are rounded in `steps` (0: sharp), 12 (2 steps + 1)^2 triangles. Outward windings.
inline MeshData make_box(glm::vec3 size, float bevel = 0, int steps = 0) {
    // Lattice coordinates per side: the flat part and `steps` cells of each rounding, normalised like a rounded cube.
    std::vector<float> ticks;
    const int n = 2 * steps + 1;
    for (int i = 0; i <= n; ++i)
        ticks.push_back(i <= steps ? -1.0f + float(i) / float(std::max(steps, 1)) * (steps ? 1.0f : 0.0f)
                                   : float(i - steps - 1) / float(std::max(steps, 1)));
    if (steps == 0) ticks = {-1.0f, 1.0f};
    const glm::vec3 core = size * 0.5f - bevel;
    const auto place = [&](glm::vec3 direction, glm::vec3 side) {
        // direction: -1..1 in the rounding's cell, side: which half of the box
        const glm::vec3 unit = glm::normalize(direction);
        return steps == 0 ? side * size * 0.5f : side * core + unit * bevel;
    };
    MeshData data;
    for (int axis = 0; axis < 3; ++axis)
        for (int sign = -1; sign <= 1; sign += 2) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const auto base = std::uint32_t(data.positions.size());
            for (int j = 0; j <= n; ++j)
                for (int i = 0; i <= n; ++i) {
                    glm::vec3 direction(0), side(0);
                    direction[axis] = side[axis] = float(sign);
                    direction[u] = ticks[std::size_t(i)], side[u] = i <= steps ? -1.0f : 1.0f;
                    direction[v] = ticks[std::size_t(j)], side[v] = j <= steps ? -1.0f : 1.0f;
                    data.positions.push_back(place(direction, side));
                }
            const auto at = [&](int i, int j) { return base + std::uint32_t(j * (n + 1) + i); };
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i) {
                    glm::uvec3 first{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
                        second{at(i, j), at(i + 1, j + 1), at(i, j + 1)};
                    if (sign < 0) std::swap(first.y, first.z), std::swap(second.y, second.z);
                    data.triangles.push_back(first);
                    data.triangles.push_back(second);
                }
        }
    return data;
}

inline MeshData make_sphere(float radius, int rings = 24, int segments = 48) {
    MeshData data;
    const double pi = std::acos(-1.0);
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const double theta = pi * r / rings, phi = 2 * pi * s / segments;
            const double ring = r == 0 || r == rings ? 0.0 : std::sin(theta);
            data.positions.push_back(
                glm::vec3(glm::dvec3(ring * std::cos(phi), ring * std::sin(phi), std::cos(theta)) * double(radius)));
        }
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const auto at = [&](int i, int j) { return std::uint32_t((r + j) * segments + (s + i) % segments); };
            if (r > 0) data.triangles.push_back({at(0, 0), at(0, 1), at(1, 0)});
            if (r + 1 < rings) data.triangles.push_back({at(1, 0), at(0, 1), at(1, 1)});
        }
    return data;
}

/// A ball whose vertices are moved in and out at random: small faces that meet in ridges and hollows.
inline MeshData make_rough_ball(unsigned seed, float radius, float roughness, int rings = 60, int segments = 120) {
    MeshData data = make_sphere(radius, rings, segments);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> spread(1 - roughness, 1 + roughness);
    // All vertices at a pole are one place, and stay it.
    for (std::size_t i = std::size_t(segments); i + std::size_t(segments) < data.positions.size(); ++i)
        data.positions[i] *= spread(random);
    return data;
}

/// A Wavefront file's positions and faces (fans); empty if there is no such file.
inline std::optional<MeshData> load_obj(const std::string& path) {
    std::ifstream file(path);
    if (!file) return std::nullopt;
    MeshData data;
    std::string line;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            glm::vec3 p(0);
            words >> p.x >> p.y >> p.z;
            data.positions.push_back(p);
        } else if (kind == "f") {
            std::vector<std::uint32_t> face;
            std::string corner;
            while (words >> corner) {
                const long index = std::stol(corner.substr(0, corner.find('/')));
                face.push_back(std::uint32_t(index > 0 ? index - 1 : long(data.positions.size()) + index));
            }
            for (std::size_t k = 2; k < face.size(); ++k) data.triangles.push_back({face[0], face[k - 1], face[k]});
        }
    }
    return data;
}

/// Looks along -Z from `eye` to `target`, +Z of the world up where possible.
inline glm::dmat4 look_at(glm::dvec3 eye, glm::dvec3 target) {
    const glm::dvec3 ahead = glm::normalize(target - eye);
    const glm::dvec3 up = std::abs(ahead.z) < 0.999 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    return glm::inverse(glm::lookAt(eye, target, up));
}

inline Camera make_camera(glm::dvec3 eye, glm::dvec3 target, int width, int height, double fov_x_deg = 50) {
    Camera camera;
    const double x = std::tan(glm::radians(fov_x_deg) / 2), y = x * height / width;
    camera.window = {-x, x, -y, y};
    camera.clip_start = 0.01;
    camera.clip_end = 1000;
    camera.world_from_camera = look_at(eye, target);
    return camera;
}

inline Light make_light(LightKind kind, glm::dvec3 place, glm::dvec3 target, double spot_angle_deg = 60) {
    Light light;
    light.name = "light";
    light.kind = kind;
    light.world_from_light = look_at(place, target);
    light.spot_angle = glm::radians(spot_angle_deg);
    return light;
}

struct SceneView {
    std::shared_ptr<Scene> scene = std::make_shared<Scene>();
    Camera camera;
    int width = 1280, height = 720;

    std::uint32_t add(std::string name, MeshData data) {
        scene->meshes.push_back(to_mesh(std::move(name), std::move(data)));
        return std::uint32_t(scene->meshes.size() - 1);
    }
    std::uint32_t place(std::uint32_t mesh, glm::dmat4 world_from_object = glm::dmat4(1.0),
                        std::uint32_t flags = kInstanceCamera | kInstanceShadow) {
        Instance instance;
        instance.mesh = mesh;
        instance.flags = flags;
        instance.world_from_object = world_from_object;
        scene->instances.push_back(instance);
        return std::uint32_t(scene->instances.size() - 1);
    }
};

inline glm::dmat4 placement(glm::dvec3 at, double turn_deg = 0, glm::dvec3 axis = {0, 0, 1}) {
    return glm::rotate(glm::translate(glm::dmat4(1), at), glm::radians(turn_deg), axis);
}

/// A sharp box over a plane.
inline SceneView box_scene(int width = 1280, int height = 720) {
    SceneView view;
    view.width = width, view.height = height;
    view.place(view.add("plane", make_plane(12)));
    view.place(view.add("box", make_box({1, 0.8f, 1.2f})), placement({0.1, -0.05, 1.1}, 27));
    view.camera = make_camera({3.2, -4.1, 3.4}, {0.3, 0.3, 0.3}, width, height);
    return view;
}

/// A tower of bevelled blocks with some pulled out and some lying about (the jenga of the reports, about 18,000
/// triangles).
inline SceneView tower_scene(int width = 1280, int height = 720) {
    SceneView view;
    view.width = width, view.height = height;
    std::mt19937 random(17);
    std::normal_distribution<double> jitter(0, 1);
    view.place(view.add("ground", make_plane(12, 7)));
    const glm::dvec3 size(0.75, 0.25, 0.15);
    const auto block = view.add("block", make_box(glm::vec3(size), 0.018f, 2));
    for (int level = 0; level < 18; ++level)
        for (int k = 0; k < 3; ++k) {
            if ((level * 7 + k * 5) % 11 == 3) continue;
            const bool pulled = (level * 3 + k) % 13 == 5;
            glm::dmat4 at = placement({0.0011 * std::pow(level, 1.6), 0, size.z * (level + 0.5)}, 90.0 * (level % 2));
            at = at *
                 placement({pulled ? 0.25 : 0.008 * jitter(random), (k - 1) * size.y * 1.02, 0}, 0.8 * jitter(random));
            view.place(block, at);
        }
    for (int k = 0; k < 9; ++k) {
        const double angle = 0.7 * k;
        view.place(block, placement({1.05 * std::cos(angle), 1.05 * std::sin(angle), size.z / 2}, 71.0 * k));
    }
    view.camera = make_camera({3.3, -3.0, 2.6}, {0, 0, 1.05}, width, height);
    return view;
}

/// A mesh on a plane, scaled to two units.
inline SceneView model_scene(MeshData data, int width = 1280, int height = 720, bool y_up = true) {
    SceneView view;
    view.width = width, view.height = height;
    Bounds bounds;
    for (const glm::vec3& p : data.positions) bounds.add(glm::dvec3(p));
    const glm::dvec3 extent = bounds.max - bounds.min;
    const double scale = 2.0 / std::max({extent.x, extent.y, extent.z});
    glm::dmat4 stand = y_up ? glm::rotate(glm::dmat4(1), glm::radians(90.0), glm::dvec3(1, 0, 0)) : glm::dmat4(1);
    const glm::dvec3 centre = (bounds.min + bounds.max) * 0.5;
    stand = stand * glm::scale(glm::dmat4(1), glm::dvec3(scale)) * glm::translate(glm::dmat4(1), -centre);
    Bounds placed;
    for (const glm::vec3& p : data.positions) placed.add(glm::dvec3(stand * glm::dvec4(glm::dvec3(p), 1)));
    view.place(view.add("plane", make_plane(12)));
    view.place(view.add("model", std::move(data)), glm::translate(glm::dmat4(1), {0, 0, -placed.min.z}) * stand);
    view.camera = make_camera({2.4, -2.6, 2.0}, {0, 0, 0.5}, width, height);
    return view;
}

/// Boxes and spheres at random over a plane.
inline SceneView random_scene(unsigned seed, int width = 640, int height = 360, int count = 14) {
    SceneView view;
    view.width = width, view.height = height;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    view.place(view.add("plane", make_plane(14, 3)));
    const auto sharp = view.add("sharp", make_box({1, 1, 1}));
    const auto round = view.add("round", make_box({1, 1, 1}, 0.15f, 3));
    const auto ball = view.add("ball", make_sphere(0.5f));
    for (int k = 0; k < count; ++k) {
        const glm::dvec3 at(1.8 * unit(random), 1.8 * unit(random), 1.0 + 0.8 * unit(random));
        const glm::dvec3 axis = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random) + 1.01));
        const glm::dvec3 size(0.35 + 0.25 * unit(random), 0.35 + 0.25 * unit(random), 0.35 + 0.25 * unit(random));
        view.place(k % 3 == 0   ? ball
                   : k % 3 == 1 ? sharp
                                : round,
                   glm::scale(placement(at, 180 * unit(random), axis), size));
    }
    view.camera = make_camera({3.6, -3.9, 3.6}, {0, 0, 0.6}, width, height);
    return view;
}

}  // namespace shadow_layers::testing
