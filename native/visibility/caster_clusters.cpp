// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/caster_clusters.h"

#include <algorithm>
#include <memory>

#include "scene/bounds.h"
#include "scene/mesh_clusters.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kCasterBlock = 16;
constexpr std::size_t kSetUpBlock = 8;
// A look at a tile costs about a tenth of a triangle's set-up.
constexpr int kTilesPerTriangle = 8;

std::shared_ptr<const MeshClusters> get_clusters(Engine& engine, const Mesh& mesh) {
    return engine.mesh_data().get_for_mesh<MeshClusters>(mesh, [&](const auto&) {
        return std::make_shared<const MeshClusters>(make_mesh_clusters(mesh, &engine.threads()));
    });
}

bool find_box_extent(const MeshClusters::Box& box, const glm::dmat4& lc_from_object, const CasterGrid& grid,
                     tile_kernel::TileExtent& extent) {
    if (box.is_empty()) return false;
    ClipCorner corners[8];
    const Bounds bounds{glm::dvec3(box.min), glm::dvec3(box.max)};
    for (int k = 0; k < 8; ++k) corners[k] = project_corner(lc_from_object, box_corner(bounds, k));
    return find_extent(corners, grid, extent);
}

}  // namespace

bool may_meet_receivers(const CasterCluster& cluster, const CasterGrid& grid) {
    return may_meet_receivers(cluster.extent, grid, kTilesPerTriangle * int(cluster.end - cluster.begin));
}

std::vector<CasterCluster> list_clusters(Engine& engine, const Scene& scene, const CasterRow& casters,
                                         const CasterGrid& grid) {
    const std::size_t count = casters.instances().size();
    std::vector<std::shared_ptr<const MeshClusters>> clusters(scene.meshes.size());  // of the meshes that cast
    for (const std::uint32_t index : casters.instances()) {
        const std::uint32_t mesh = scene.instances[index].mesh;
        if (!clusters[mesh]) clusters[mesh] = get_clusters(engine, *scene.meshes[mesh]);
    }
    std::vector<std::vector<CasterCluster>> parts((count + kCasterBlock - 1) / kCasterBlock);
    engine.threads().parallel_for(count, kCasterBlock, [&](std::size_t from, std::size_t to) {
        std::vector<CasterCluster>& part = parts[from / kCasterBlock];
        for (std::size_t caster = from; caster < to; ++caster) {
            std::size_t begin = casters.first(caster);
            for (const MeshClusters::Box& box : clusters[scene.instances[casters.instances()[caster]].mesh]->boxes) {
                CasterCluster cluster;
                cluster.begin = begin;
                cluster.end = begin = std::min(begin + kClusterTriangles, casters.first(caster + 1));
                if (find_box_extent(box, casters.lc_from_object(caster), grid, cluster.extent) &&
                    may_meet_receivers(cluster, grid))
                    part.push_back(cluster);
            }
        }
    });
    std::vector<CasterCluster> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end(), [](const CasterCluster& a, const CasterCluster& b) {
        return a.extent.greatest_depth != b.extent.greatest_depth ? a.extent.greatest_depth > b.extent.greatest_depth
                                                                  : a.begin < b.begin;
    });
    return all;
}

std::vector<tile_kernel::CasterTriangle> set_up_clusters(ThreadPool& threads, const CasterRow& casters,
                                                         std::span<const CasterCluster> clusters,
                                                         const CasterGrid& grid) {
    std::vector<tile_kernel::CasterTriangle> triangles(clusters.size() * kClusterTriangles);
    std::vector<std::size_t> kept(clusters.size());
    threads.parallel_for(clusters.size(), kSetUpBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
            kept[i] = casters.set_up(clusters[i].begin, clusters[i].end, grid, &triangles[i * kClusterTriangles]);
    });
    std::size_t end = kept.empty() ? 0 : kept[0];
    for (std::size_t i = 1; i < clusters.size(); ++i)
        for (std::size_t k = 0; k < kept[i]; ++k) triangles[end++] = triangles[i * kClusterTriangles + k];
    triangles.resize(end);
    return triangles;
}

}  // namespace shadow_layers
