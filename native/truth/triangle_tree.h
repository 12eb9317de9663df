// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "frame/frame.h"
#include "truth/ray_oracle.h"

namespace shadow_layers::truth {

/// A linear function of a point p: dot(xyz, p) + w. Of a half-space: not negative inside.
using Linear = glm::dvec4;

inline double evaluate(const Linear& function, const glm::dvec3& p) {
    return glm::dot(glm::dvec3(function), p) + function.w;
}

/// All triangles of a scene, to be found by convex parts of space: a tree of boxes. Positions are relative to the
/// oracle's origin. Read by any number of threads.
class TriangleTree {
public:
    struct Triangle {
        Corners corners;
        PixelIds ids;
    };

    TriangleTree(const RayOracle& oracle, const Scene& scene);

    /// Calls `visit` for every triangle that may reach into the common part of the half-spaces, and for others near it.
    void find(std::span<const Linear> half_spaces, const std::function<void(const Triangle&)>& visit) const;

private:
    struct Node {
        glm::dvec3 low{0.0}, high{0.0};
        std::uint32_t begin = 0, end = 0;  ///< of triangles_
        std::uint32_t right = 0;           ///< the left child follows its parent; 0: a leaf
    };
    void build(std::uint32_t begin, std::uint32_t end);
    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace shadow_layers::truth
