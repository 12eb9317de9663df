// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "stages/depth_map.h"
#include "stages/map_edges.h"

namespace shadow_layers {

/// For each cell between four texel centres of the depth map a point of the silhouette edge that crosses it, in the
/// cell's own unit square; (1/2, 1/2) without an edge. RG16F array with a layer per view; cell (i, j) has its lower
/// left corner at the centre of texel (i, j). Of several edges in a cell the last one drawn is kept.
struct SilhouetteMap {
    std::shared_ptr<const gl::Texture> texture;
    std::int64_t silhouette_edges = 0;  ///< found in the meshes
    std::int64_t edge_quads = 0;        ///< drawn, over all views
    std::size_t byte_size() const { return texture->byte_size(); }
};

/// Cached by the depth map's key. Counts "silhouette_edges", "edge_quads", "map_bytes".
std::shared_ptr<const SilhouetteMap> render_silhouette_map(Engine& engine, const Scene& scene,
                                                           const LightSample& sample, const DepthMap& depth_map);

}  // namespace shadow_layers
