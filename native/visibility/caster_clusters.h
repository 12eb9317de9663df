// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/engine.h"
#include "visibility/caster_forms.h"

namespace shadow_layers {

/// Consecutive triangles of a CasterRow, all of one caster.
struct CasterCluster {
    std::size_t begin, end;
    tile_kernel::TileExtent extent;  ///< of the box round them
};

/// The clusters of a view's casters (scene/mesh_clusters.h) that touch the grid and may shadow a receiver there, from
/// the nearest to the light on: what they shadow need not be compared with the clusters behind them.
std::vector<CasterCluster> list_clusters(Engine& engine, const Scene& scene, const CasterRow& casters,
                                         const CasterGrid& grid);

/// Asked again before a cluster is drawn: those before it may have left no receiver behind it.
bool may_meet_receivers(const CasterCluster& cluster, const CasterGrid& grid);

/// The triangles of these clusters, set up over the grid by CasterRow::set_up, in their order.
std::vector<tile_kernel::CasterTriangle> set_up_clusters(ThreadPool& threads, const CasterRow& casters,
                                                         std::span<const CasterCluster> clusters,
                                                         const CasterGrid& grid);

}  // namespace shadow_layers
