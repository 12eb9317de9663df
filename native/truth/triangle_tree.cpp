// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/triangle_tree.h"

#include <algorithm>

namespace shadow_layers::truth {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;

/// The corner of a box that lies farthest inside of the half-space.
glm::dvec3 find_inmost(const Linear& half_space, const glm::dvec3& low, const glm::dvec3& high) {
    return {half_space.x > 0 ? high.x : low.x, half_space.y > 0 ? high.y : low.y, half_space.z > 0 ? high.z : low.z};
}

}  // namespace

TriangleTree::TriangleTree(const RayOracle& oracle, const Scene& scene) {
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const auto count = std::uint32_t(scene.meshes[scene.instances[i].mesh]->triangles.size());
        for (std::uint32_t t = 0; t < count; ++t) triangles_.push_back({oracle.get_corners({i, t}), {i, t}});
    }
    if (!triangles_.empty()) build(0, std::uint32_t(triangles_.size()));
}

void TriangleTree::build(std::uint32_t begin, std::uint32_t end) {
    const std::size_t index = nodes_.size();
    Node node;
    node.begin = begin, node.end = end;
    node.low = node.high = triangles_[begin].corners[0];
    for (std::uint32_t i = begin; i < end; ++i) {
        for (const glm::dvec3& corner : triangles_[i].corners) {
            node.low = glm::min(node.low, corner);
            node.high = glm::max(node.high, corner);
        }
    }
    nodes_.push_back(node);
    if (end - begin <= kLeafTriangles) return;
    const glm::dvec3 size = node.high - node.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = [&](const Triangle& t) { return t.corners[0][axis] + t.corners[1][axis] + t.corners[2][axis]; };
    const std::uint32_t half = begin + (end - begin) / 2;
    std::nth_element(triangles_.begin() + begin, triangles_.begin() + half, triangles_.begin() + end,
                     [&](const Triangle& a, const Triangle& b) { return middle(a) < middle(b); });
    build(begin, half);
    nodes_[index].right = std::uint32_t(nodes_.size());
    build(half, end);
}

void TriangleTree::find(std::span<const Linear> half_spaces, const std::function<void(const Triangle&)>& visit) const {
    std::array<std::uint32_t, 64> stack;
    std::size_t open = 0;
    if (!nodes_.empty()) stack[open++] = 0;
    while (open > 0) {
        const std::uint32_t index = stack[--open];
        const Node& node = nodes_[index];
        const bool outside = std::any_of(half_spaces.begin(), half_spaces.end(), [&](const Linear& half_space) {
            return evaluate(half_space, find_inmost(half_space, node.low, node.high)) < 0;
        });
        if (outside) continue;
        if (node.right != 0) {
            stack[open++] = node.right;
            stack[open++] = index + 1;
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) visit(triangles_[i]);
    }
}

}  // namespace shadow_layers::truth
