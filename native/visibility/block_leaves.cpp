// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/block_leaves.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "visibility/node_boxes.h"

namespace shadow_layers {
namespace {

using soft_kernel::kWidth;
using soft_kernel::Leaf;
using soft_kernel::Node;

// Only triangles that rise over the receivers' plane by less than this part of their distance are asked for flat
// neighbours: kFlatTolerance, with a reserve.
constexpr double kAlmostFlat = 1e-5;

}  // namespace

/// May it be one of the receivers' own surfaces?
bool BlockLeaves::lies_flat(const Triangle& t) const {
    if (!shaft_.has_plane) return true;
    const glm::dvec3 normal(shaft_.normal[0], shaft_.normal[1], shaft_.normal[2]);
    const double at = glm::dot(normal, t.a) - double(shaft_.offset);
    const double rise = at + std::max({0.0, glm::dot(normal, t.edge_1), glm::dot(normal, t.edge_2)});
    const glm::dvec3 size = glm::max(glm::abs(t.box.min), glm::abs(t.box.max));
    return rise <= kAlmostFlat * (size.x + size.y + size.z + std::abs(double(shaft_.offset)));
}

std::uint32_t BlockLeaves::find_alive(std::span<const Triangle> triangles) const {
    Node boxes = make_empty_node();
    for (std::size_t i = 0; i < triangles.size(); ++i) set_box(boxes, int(i), triangles[i].box, {kBoxRounding, 0}, 0);
    return build_.test_shaft(shaft_, boxes);
}

std::size_t BlockLeaves::add(const Leaf& leaf, const OcclusionRule& rule, std::span<const PixelIds> own) {
    Triangle found[kWidth];
    std::size_t count = 0;
    const double margin = kBoxRounding * double(leaf.size);
    for (std::uint32_t lanes = leaf.lanes; lanes != 0; lanes &= lanes - 1) {
        const int i = std::countr_zero(lanes);
        Triangle& t = found[count++];
        t.box = {};
        for (int k = 0; k < 3; ++k) {
            t.a[k] = double(leaf.a[k][i]) + leaf.origin[k];
            t.edge_1[k] = leaf.edge_1[k][i], t.edge_2[k] = leaf.edge_2[k][i];
            t.box.min[k] = t.a[k] + std::min({0.0, t.edge_1[k], t.edge_2[k]}) - margin;
            t.box.max[k] = t.a[k] + std::max({0.0, t.edge_1[k], t.edge_2[k]}) + margin;
        }
        t.ids = {leaf.instance[i], leaf.triangle[i]};
    }
    std::size_t kept = 0;
    for (std::uint32_t alive = find_alive({found, count}); alive != 0; alive &= alive - 1) {
        const Triangle& t = found[std::countr_zero(alive)];
        const auto never_shadows = [&](const PixelIds& receiver) { return rule.is_own_surface(receiver, t.ids); };
        if (!own.empty() && lies_flat(t) && std::all_of(own.begin(), own.end(), never_shadows)) continue;
        ++kept;
        if (!can_pack()) continue;
        triangles_.push_back(t);
    }
    return kept;
}

/// Halved by place along the longer side until eight are left: what lies together comes into one leaf.
void BlockLeaves::sort() {
    const auto halve = [](const auto& self, std::span<Triangle> part) -> void {
        if (part.size() <= std::size_t(kWidth)) return;
        Bounds box;
        for (const Triangle& t : part) box.add(t.box);
        const glm::dvec3 size = box.max - box.min;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t middle = (part.size() / kWidth + 1) / 2 * kWidth;
        std::nth_element(part.begin(), part.begin() + std::ptrdiff_t(middle), part.end(),
                         [axis](const Triangle& a, const Triangle& b) {
                             return a.box.min[axis] + a.box.max[axis] < b.box.min[axis] + b.box.max[axis];
                         });
        self(self, part.first(middle));
        self(self, part.subspan(middle));
    };
    halve(halve, triangles_);
}

void BlockLeaves::pack() {
    sort();
    for (std::size_t first = 0; first < triangles_.size(); first += kWidth) {
        const std::size_t count = std::min<std::size_t>(kWidth, triangles_.size() - first);
        Leaf leaf{};
        Bounds box;
        double size = 0;
        for (int k = 0; k < 3; ++k) leaf.origin[k] = middle_[k];
        leaf.lanes = (1u << count) - 1;
        for (std::size_t i = 0; i < count; ++i) {
            const Triangle& t = triangles_[first + i];
            box.add(t.box);
            leaf.instance[i] = t.ids.instance, leaf.triangle[i] = t.ids.triangle;
            for (int k = 0; k < 3; ++k) {
                leaf.a[k][i] = float(t.a[k] - middle_[k]);
                leaf.edge_1[k][i] = float(t.edge_1[k]), leaf.edge_2[k][i] = float(t.edge_2[k]);
                size = std::max({size, std::abs(t.box.min[k] - middle_[k]), std::abs(t.box.max[k] - middle_[k])});
            }
        }
        leaf.size = float(size * (1 + 1e-6));
        leaves_.push_back(leaf);
        boxes_.push_back(box);
    }
}

}  // namespace shadow_layers
