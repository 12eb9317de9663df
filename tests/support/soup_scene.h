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

}  // namespace shadow_layers::testing
