// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "stages/depth_map.h"
#include "stages/map_edges.h"
#include "techniques/extsm/extended_quads.h"

namespace shadow_layers {

/// Beside the depth map, per texel and layer of a view: the edge's value (R8: see extended_map.h) and
/// its depth (R32F: depth_rz times `depth_sign`, below kNoEdgeBound where there is no edge).
struct ExtendedShadowMap {
    std::shared_ptr<const gl::Texture> values, depths;
    std::int64_t silhouette_edges = 0, bevelled_edges = 0, edge_quads = 0;
    std::size_t byte_size() const { return values->byte_size() + depths->byte_size(); }
};

struct ExtendedMapOptions {
    bool farthest_edge = true;  ///< of edges that overlap in a texel, keep the farthest depth; else the nearest
    bool forced = false;        ///< quads across the edge in the map, closeness to its segment; else [Bujnak04] 4.1
    double guard_zone = 0.25;   ///< part of the quad, from its inner end on, that stores the value of its outer end
    float depth_sign() const { return farthest_edge ? -1.0f : 1.0f; }
    /// Half the width of a forced quad: an edge matters to texels whose 2 x 2 footprint it crosses.
    double half_width_texels() const { return kTexelDiagonal; }
};

/// Cached by the depth map's key and the options. Counts "silhouette_edges", "bevelled_edges", "edge_quads",
/// "map_bytes".
std::shared_ptr<const ExtendedShadowMap> render_extended_shadow_map(Engine& engine, const Scene& scene,
                                                                    const LightSample& sample,
                                                                    const DepthMap& depth_map,
                                                                    const ExtendedMapOptions& options);

}  // namespace shadow_layers
