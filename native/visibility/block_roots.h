// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "visibility/block_leaves.h"
#include "visibility/caster_tree.h"
#include "visibility/occlusion_rule.h"
#include "visibility/soft_kernel.h"
#include "visibility/soft_part.h"

namespace shadow_layers {

/// Where the receivers of a block enter a tree: what the block's shaft leaves of it.
class BlockRoots {
public:
    explicit BlockRoots(const soft_kernel::Build& build) : build_(build) {}

    struct Block {
        const SoftPart& part;
        soft_kernel::Shaft shaft;
        Bounds places;                          ///< of the receivers, in the part's frame
        std::span<const PixelIds> own;          ///< the triangles that they lie on, if they are few
        const soft_kernel::Receiver& receiver;  ///< any of them
    };
    void find(const Block& block, const CasterTree& tree, const OcclusionRule& rule);

    /// Nothing of the tree can hide anything from any receiver.
    bool is_empty() const { return nodes_.empty() && !is_dark_; }
    /// One triangle hides the whole light from all receivers.
    bool is_dark() const { return is_dark_; }
    soft_kernel::Roots view() const { return {nodes_.data(), int(nodes_.size()), leaves_.data()}; }

private:
    static constexpr std::size_t kMostRoots = 32;
    struct Root {
        float low[3], high[3];
        std::uint32_t link;
    };
    void open_nodes(const Block& block, const CasterTree& tree);
    void add_children(const soft_kernel::Node& node, std::uint32_t alive);
    int take_lane();
    void add(const Root& root);
    void add_packed(const Block& block, BlockLeaves& packed);
    bool is_covered_by(const Block& block, const soft_kernel::Leaf& leaf) const;

    const soft_kernel::Build& build_;
    Root found_[kMostRoots + soft_kernel::kWidth];
    std::size_t found_count_ = 0, count_ = 0;
    std::vector<soft_kernel::Node> nodes_;
    std::vector<soft_kernel::Leaf> leaves_;
    bool is_dark_ = false;
};

}  // namespace shadow_layers
