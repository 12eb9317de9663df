// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "edge_map.h"
#include "engine/engine.h"
#include "lights/light_views.h"
#include "scene/adjacency.h"
#include "scene/silhouettes.h"

namespace shadow_layers {

/// An edge in light clip space to an edge in the map: cut at the near side (w > 0), at the far plane and at a frame of
/// `half_width_texels` round the map, all in double. False if nothing is left. `foreshortened`: quads keep their width
/// in texels (false), or shrink with the distance from the light as if built before the perspective division (true, w =
/// near / w).
bool project_edge(const LightView& view, glm::dvec4 start_lc, glm::dvec4 end_lc, double half_width_texels,
                  bool foreshortened, MapEdge& result);

struct MapEdgeOptions {
    SilhouetteOptions silhouettes;
    double half_width_texels = 1.5;  ///< half the width of a quad
    bool foreshortened = false;      ///< quads built before the perspective division
};

/// Silhouette edges as each view of a light sample sees them.
struct MapEdges {
    std::vector<std::vector<MapEdge>> by_view;  ///< in the order of instances and of their edges
    std::int64_t silhouette_edges = 0;          ///< found, before any view cuts them
};
MapEdges find_map_edges(Engine& engine, const Scene& scene, const LightSample& sample, const MapEdgeOptions& options);

}  // namespace shadow_layers
