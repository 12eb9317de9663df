// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A half-plane's shadow, whose layers have closed forms.

#include <algorithm>
#include <atomic>

#include "support/technique_scenes.h"
#include "truth/exact_layers.h"

namespace shadow_layers::testing {

/// A floor seen from straight above; a sheet over its half x < 0 that only casts; a sun straight above.
struct HalfPlaneScene {
    static constexpr int kWidth = 64, kHeight = 8;
    static constexpr double kReach = 0.8;  ///< half the width of what the camera sees
    static constexpr double kBlockerHeight = 1, kSunAngle = 0.4;

    std::shared_ptr<Scene> scene = std::make_shared<Scene>();
    Camera camera;

    HalfPlaneScene() {
        scene->meshes = {to_mesh("floor", make_plane(20)), to_mesh("sheet", make_plane(10))};
        Instance floor, sheet;
        floor.flags = kInstanceCamera | kInstanceShadow;
        sheet.mesh = 1;
        sheet.flags = kInstanceShadow;
        sheet.world_from_object[3] = glm::dvec4(-5, 0, kBlockerHeight, 1);
        scene->instances = {floor, sheet};
        Light sun;
        sun.name = "Sun";
        sun.kind = LightKind::Sun;
        sun.sun_angle = kSunAngle;
        scene->lights = {sun};
        camera.perspective = false;
        camera.window = {-kReach, kReach, -0.1, 0.1};
        camera.clip_start = 0.1, camera.clip_end = 100;
        camera.world_from_camera = glm::dmat4(1.0);
        camera.world_from_camera[3] = glm::dvec4(0, 0, 5, 1);
    }

    static double x_of(std::size_t pixel) {
        return ((double(pixel % std::size_t(kWidth)) + 0.5) / kWidth * 2 - 1) * kReach;
    }
    /// Turns the camera about its view, so that pixels are crossed aslant, and moves it to the right. Edges of the
    /// scene along y then run through the picture at that angle.
    void turn_camera(double angle, double aside) {
        camera.world_from_camera = glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(0, 0, 1));
        camera.world_from_camera[3] = glm::dvec4(aside, 0, 5, 1);
    }
    /// Of a pixel's square the part with x > edge in the world.
    double find_part_beyond(std::size_t pixel, double edge) const {
        const double side = 2 * kReach / kWidth;
        const glm::dvec2 axis = glm::dvec2(camera.world_from_camera[0].x, camera.world_from_camera[1].x) * side;
        const double column = double(pixel % std::size_t(kWidth)) + 0.5 - 0.5 * kWidth;
        const double row = double(pixel / std::size_t(kWidth)) + 0.5 - 0.5 * kHeight;
        const double x = camera.world_from_camera[3].x + column * axis.x + row * axis.y;
        // Of the unit square {a u + b v <= c}, by the squares of what the corners are inside of the edge.
        const double a = std::abs(axis.x), b = std::abs(axis.y), c = 0.5 * (a + b) - (edge - x);
        const auto square = [](double value) { return value > 0 ? value * value : 0; };
        return (square(c) - square(c - a) - square(c - b) + square(c - a - b)) / (2 * a * b);
    }
    std::vector<float> compute(const TruthSpec& spec, int map_size = 256) const {
        const std::atomic<bool> cancelled{false};
        return truth::ExactLayers(scene, camera, kWidth, kHeight, 1, cancelled).compute(0, spec, map_size);
    }
};

}  // namespace shadow_layers::testing
