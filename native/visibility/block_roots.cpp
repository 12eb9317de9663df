// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/block_roots.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "scene/bounds.h"

namespace shadow_layers {
namespace {

using soft_kernel::kLeaf;
using soft_kernel::kNoChild;
using soft_kernel::kWidth;
using soft_kernel::Leaf;
using soft_kernel::Node;
using soft_kernel::Receiver;

}  // namespace

void BlockRoots::find(const Block& block, const CasterTree& tree, const OcclusionRule& rule) {
    nodes_.clear();
    leaves_.clear();
    found_count_ = count_ = 0;
    is_dark_ = false;
    if (tree.is_empty()) return;
    open_nodes(block, tree);
    BlockLeaves packed(build_, block.shaft, 0.5 * (block.places.min + block.places.max));
    bool is_left[kMostRoots + kWidth];
    for (std::size_t i = 0; i < found_count_; ++i) {
        is_left[i] = true;
        if (!(found_[i].link & kLeaf)) continue;
        const Leaf& leaf = tree.view().leaves[found_[i].link & ~kLeaf];
        is_left[i] = packed.add(leaf, rule, block.own) > 0;
        if (!is_left[i] || !is_covered_by(block, leaf)) continue;
        is_dark_ = true;
        return;
    }
    const bool packs = packed.can_pack();
    for (std::size_t i = 0; i < found_count_; ++i)
        if (is_left[i] && !(packs && (found_[i].link & kLeaf))) add(found_[i]);
    if (packs) add_packed(block, packed);
}

/// From the top as long as few enough are left.
void BlockRoots::open_nodes(const Block& block, const CasterTree& tree) {
    add_children(tree.root(), build_.test_shaft(block.shaft, tree.root()));
    for (std::size_t next = 0; next < found_count_;) {
        if (found_[next].link & kLeaf) {
            ++next;
            continue;
        }
        const Node& node = tree.view().nodes[found_[next].link];
        const std::uint32_t alive = build_.test_shaft(block.shaft, node);
        if (found_count_ - 1 + std::size_t(std::popcount(alive)) > kMostRoots) return;
        found_[next] = found_[--found_count_];
        add_children(node, alive);
    }
}

void BlockRoots::add_children(const Node& node, std::uint32_t alive) {
    for (; alive != 0; alive &= alive - 1) {
        const int i = std::countr_zero(alive);
        Root& root = found_[found_count_++];
        for (int k = 0; k < 3; ++k) root.low[k] = node.low[k][i], root.high[k] = node.high[k][i];
        root.link = node.child[i];
    }
}

/// The next free child of the last node.
int BlockRoots::take_lane() {
    const int lane = int(count_++ % kWidth);
    if (lane == 0) nodes_.push_back(make_empty_node());
    return lane;
}

void BlockRoots::add(const Root& root) {
    const int lane = take_lane();
    Node& node = nodes_.back();
    for (int k = 0; k < 3; ++k) node.low[k][lane] = root.low[k], node.high[k][lane] = root.high[k];
    node.child[lane] = root.link;
}

void BlockRoots::add_packed(const Block& block, BlockLeaves& packed) {
    packed.pack();
    leaves_.assign(packed.leaves().begin(), packed.leaves().end());
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
        const int lane = take_lane();
        set_box(nodes_.back(), lane, packed.box(i), block.part.widening(),
                kLeaf | soft_kernel::kOfBlock | std::uint32_t(i));
    }
}

/// Receivers that one sample does not see lie in a convex part of space, and so do samples that one receiver does not
/// see: the corners of both boxes answer for what is inside.
bool BlockRoots::is_covered_by(const Block& block, const Leaf& leaf) const {
    Bounds box = block.places;
    const double margin = kBoxRounding * block.part.largest_place;
    box.min -= margin, box.max += margin;
    Receiver corner = block.receiver;
    corner.instance = corner.triangle = kNoChild;
    corner.least_slope = 0;
    for (int k = 0; k < 3; ++k) corner.normal[k] = k == 2 ? 1.0f : 0.0f;
    std::uint32_t lanes = leaf.lanes;
    for (int k = 0; k < 8 && lanes != 0; ++k) {
        set_place(block.part, box_corner(box, k), corner);
        lanes &= build_.find_covering(leaf, corner, block.part.box_set);
    }
    return lanes != 0;
}

}  // namespace shadow_layers
