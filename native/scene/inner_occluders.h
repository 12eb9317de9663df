// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>

#include "scene/box_tree.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

/// Large triangles inside of a closed mesh. A segment that meets one of them and ends outside of the mesh crosses the
/// mesh's surface behind it, for sure: so they stand for the many small triangles of that surface where only shadow is
/// asked for. What they do not hide may still be hidden by the surface.
struct InnerOccluders {
    std::shared_ptr<const Mesh> mesh;  ///< object space; null: none, as of a mesh that is open, thin or coarse
    std::shared_ptr<const BoxTree> tree;
    std::size_t byte_size() const {
        return sizeof *this +
               (mesh ? mesh->positions.size_bytes() + mesh->triangles.size_bytes() + tree->byte_size() : 0);
    }
};

/// "Closed" is decided by edges, welded by position: each must belong to an even number of triangles. Then every point
/// has a parity, odd inside. The inside is found on a grid of cells that no triangle touches, and filled with boxes; a
/// box is stood for by its three middle rectangles.
std::shared_ptr<const InnerOccluders> make_inner_occluders(const Mesh& mesh, ThreadPool* threads = nullptr);

}  // namespace shadow_layers
