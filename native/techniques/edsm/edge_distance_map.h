// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "stages/depth_map.h"
#include "stages/map_edges.h"

namespace shadow_layers {

/// For each texel near a silhouette edge that the light sees: the edge's line, as shaders/shared/edge_map.h says.
/// RGBA16F array with a layer per view.
struct EdgeDistanceMap {
    std::shared_ptr<const gl::Texture> texture;
    std::int64_t silhouette_edges = 0;  ///< found in the meshes
    std::int64_t edge_quads = 0;        ///< drawn, over all views
    std::int64_t edge_fragments = 0;    ///< shaded
    std::size_t byte_size() const { return texture->byte_size(); }
};

/// Which edge a texel keeps, as in shaders/lib/edge_lib.glsl.
enum class EdgeOrder : int { Stream = 0, Min = 1, Thesis = 2, Corrected = 3 };

struct EdgeDistanceOptions {
    MapEdgeOptions edges;
    EdgeOrder order = EdgeOrder::Corrected;
    bool own_texel_test = false;  ///< an edge is seen if it passes the test of the texel itself, as in the thesis
};

/// What a view's edge depths are multiplied by, so that half floats hold them (edge_depth_lib.glsl).
double compute_edge_depth_scale(const LightView& view);

/// Cached by the depth map's key and the options. Counts "silhouette_edges", "edge_quads", "edge_fragments",
/// "map_bytes".
std::shared_ptr<const EdgeDistanceMap> render_edge_distance_map(Engine& engine, const Scene& scene,
                                                                const LightSample& sample, const DepthMap& depth_map,
                                                                const EdgeDistanceOptions& options);

}  // namespace shadow_layers
