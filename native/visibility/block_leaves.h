// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "shadow_layers/scene.h"
#include "visibility/occlusion_rule.h"
#include "visibility/soft_kernel.h"

namespace shadow_layers {

/// Triangles that may hide something from a block's receivers, packed anew where they are few: those of many half-empty
/// leaves, less those that a closer look leaves out, in full leaves about the block's middle.
class BlockLeaves {
public:
    BlockLeaves(const soft_kernel::Build& build, const soft_kernel::Shaft& shaft, const glm::dvec3& middle)
        : build_(build), shaft_(shaft), middle_(middle) {}

    /// `own`: the triangles that the receivers lie on, if they are few; what never shadows any of them is left out.
    /// Returns how many triangles of the leaf are left.
    std::size_t add(const soft_kernel::Leaf& leaf, const OcclusionRule& rule, std::span<const PixelIds> own);
    /// Few enough for leaves of the block's own?
    bool can_pack() const { return triangles_.size() <= kMostTriangles; }
    /// Ends the adding.
    void pack();

    std::span<const soft_kernel::Leaf> leaves() const { return leaves_; }
    const Bounds& box(std::size_t leaf) const { return boxes_[leaf]; }

private:
    static constexpr std::size_t kMostTriangles = 48;
    struct Triangle {
        glm::dvec3 a, edge_1, edge_2;
        Bounds box;
        PixelIds ids;
    };
    void sort();
    std::uint32_t find_alive(std::span<const Triangle> triangles) const;
    bool lies_flat(const Triangle& triangle) const;

    const soft_kernel::Build& build_;
    const soft_kernel::Shaft& shaft_;
    glm::dvec3 middle_;
    std::vector<Triangle> triangles_;
    std::vector<soft_kernel::Leaf> leaves_;
    std::vector<Bounds> boxes_;
};

}  // namespace shadow_layers
