// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>
#include <string>
#include <utility>

#include "support/technique_scenes.h"

namespace shadow_layers::testing {

/// A mesh about (0, 0, 1.6) over a plane.
inline SceneView place_over_plane(std::string name, MeshData mesh, int width = 320, int height = 180) {
    SceneView view;
    view.width = width, view.height = height;
    view.place(view.add("plane", make_plane(9, 3)));
    view.place(view.add(std::move(name), std::move(mesh)));
    view.camera = make_camera({4.2, -4.4, 4.0}, {0, 0, 0.8}, width, height);
    return view;
}

/// Triangles at random over a plane: large and small ones, every third a sliver, half of them sharing an edge with the
/// one before.
inline SceneView make_soup_scene(unsigned seed, int width = 320, int height = 180, int count = 150) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto point = [&](float reach) { return reach * glm::vec3(unit(random), unit(random), unit(random)); };
    MeshData soup;
    for (int k = 0; k < count; ++k) {
        const auto first = std::uint32_t(soup.positions.size());
        const float size = k % 7 == 0 ? 2.0f : 0.6f;
        const glm::vec3 corner = point(1.5f) + glm::vec3(0, 0, 1.7f), along = point(size);
        const glm::vec3 across = k % 3 == 0 ? 0.4f * along + point(1e-3f * size) : point(size);
        soup.positions.insert(soup.positions.end(), {corner, corner + along, corner + across, corner + point(size)});
        soup.triangles.push_back({first, first + 1, first + 2});
        if (k % 2 == 0) soup.triangles.push_back({first, first + 3, first + 1});
    }
    return place_over_plane("soup", std::move(soup), width, height);
}

/// Needles at random over a plane: triangles up to 100 times longer than the picture's scene, and as thin as a hair of
/// it. Some pass close by the place (0.7, 0.4, 3.5), where tests put their light, and reach behind it.
inline SceneView make_needle_scene(unsigned seed, int width = 320, int height = 180, int count = 60) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto point = [&](float reach) { return reach * glm::vec3(unit(random), unit(random), unit(random)); };
    MeshData needles;
    for (int k = 0; k < count; ++k) {
        const auto first = std::uint32_t(needles.positions.size());
        const float reach = k % 4 == 0 ? 100.0f : 3.0f, thin = k % 3 == 0 ? 1e-4f : 0.05f;
        const glm::vec3 middle =
            k % 5 == 0 ? glm::vec3(0.7f, 0.4f, 3.5f) + point(0.3f) : glm::vec3(0, 0, 1.5f) + point(1.2f);
        const glm::vec3 along = point(reach);
        needles.positions.insert(needles.positions.end(), {middle - along, middle + along, middle + point(thin)});
        needles.triangles.push_back({first, first + 1, first + 2});
    }
    return place_over_plane("needles", std::move(needles), width, height);
}

}  // namespace shadow_layers::testing
