// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "shadow_layers/scene.h"

namespace shadow_layers {

class ThreadPool;

/// Nodes of a tree have up to this many children, and leaves up to as many triangles: both are tested side by side.
inline constexpr std::size_t kTreeWidth = 8;

/// A tree of boxes over numbered items, such as the usable triangles of a mesh (scene/bounds.h) in object space.
struct BoxTree {
    static constexpr std::uint32_t kLeaf =
        0x80000000u;  ///< child: this bit and the leaf's number; else a node's number
    static constexpr std::uint32_t kNoChild = 0xffffffffu;

    struct Node {
        float low[3][kTreeWidth], high[3][kTreeWidth];  ///< exact; low > high where there is no child
        std::uint32_t child[kTreeWidth];
    };
    std::vector<Node> nodes;                ///< the root first, every child after its parent; empty: there is no item
    std::vector<std::uint32_t> leaf_first;  ///< per leaf its first entry in `items`, and one past the last
    std::vector<std::uint32_t> items;       ///< of a mesh: numbers of triangles
    double cost = 0;                        ///< expected tests of a line through the root's box (surface areas)
    double made_cost = 0;  ///< the same when the tree was made, before it was fitted to other positions

    std::size_t leaf_count() const { return leaf_first.empty() ? 0 : leaf_first.size() - 1; }
    std::size_t byte_size() const {
        return nodes.size() * sizeof(Node) + (leaf_first.size() + items.size()) * sizeof(std::uint32_t);
    }
};

/// An item's box; low > high: left out.
struct ItemBox {
    float low[3], high[3];
};

/// Splits by surface areas (I. Wald, On fast construction of SAH-based bounding volume hierarchies, 2007: binned). The
/// result does not depend on the number of threads. `threads` may be null.
std::shared_ptr<const BoxTree> make_box_tree(std::span<const ItemBox> boxes, ThreadPool* threads = nullptr);

/// Of the usable triangles of a mesh.
std::shared_ptr<const BoxTree> make_mesh_tree(const Mesh& mesh, ThreadPool* threads = nullptr);

/// The same tree over moved positions: `mesh` has the topology that `tree` was made for. Null if vertices have become
/// usable or unusable, or if the tree would cost more than twice what it did when it was made: then it is better made
/// anew.
std::shared_ptr<const BoxTree> refit_mesh_tree(const BoxTree& tree, const Mesh& mesh, ThreadPool* threads = nullptr);

}  // namespace shadow_layers
