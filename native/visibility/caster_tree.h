// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "scene/box_tree.h"
#include "shadow_layers/scene.h"
#include "visibility/light_frame.h"
#include "visibility/node_boxes.h"
#include "visibility/soft_kernel.h"

namespace shadow_layers {

class ThreadPool;

/// An instance that may cast into a shaft, with the tree of its mesh, or of what stands for the mesh.
struct TreeCaster {
    std::uint32_t instance = 0;
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const BoxTree> tree;
    std::uint32_t told_instance = 0;  ///< what leaves name as their instance
};

/// The casters of a light in one of its frames, as soft_kernel.h traverses them: their meshes' trees, with boxes and
/// triangles brought into the frame, under a tree of the instances. What can't cast into the shaft is left out.
class CasterTree {
public:
    /// `largest_place`, `place_error`: bounds of the receivers' coordinates in the frame and of how far off they may
    /// be; boxes are widened by what rounding makes of them.
    CasterTree(const Scene& scene, const glm::dvec3& picture_origin_ws, const LightFrame& frame,
               const soft_kernel::Shaft& shaft, std::span<const TreeCaster> casters, const BoxWidening& widening,
               ThreadPool& threads);
    ~CasterTree();

    bool is_empty() const { return root_ == nullptr; }
    /// The one node at the top.
    const soft_kernel::Node& root() const { return *root_; }
    soft_kernel::Tree view() const { return {nodes_.get(), leaves_.get()}; }
    std::size_t byte_size() const;
    /// Of one instance with this tree.
    static std::size_t bytes_needed(const BoxTree& tree);

private:
    class Maker;
    struct Release {
        void operator()(void* memory) const;
    };
    std::unique_ptr<soft_kernel::Node[], Release> nodes_;
    std::unique_ptr<soft_kernel::Leaf[], Release> leaves_;
    std::size_t node_count_ = 0, leaf_count_ = 0;
    const soft_kernel::Node* root_ = nullptr;
};

/// The instances that cast for the light and may cast into the shaft.
std::vector<std::uint32_t> find_shaft_casters(const Scene& scene, const Light& light,
                                              const glm::dvec3& picture_origin_ws, const LightFrame& frame,
                                              const soft_kernel::Shaft& shaft, const BoxWidening& widening,
                                              ThreadPool& threads);

}  // namespace shadow_layers
