// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/map_edges.h"

#include <algorithm>
#include <map>
#include <set>

namespace shadow_layers {
namespace {

/// Keeps the part of [start, end] where the linear function is >= 0, given its values at both ends.
bool cut(double at_start, double at_end, double& from, double& to) {
    if (at_start < 0 && at_end < 0) return false;
    if (at_start < 0) from = std::max(from, at_start / (at_start - at_end));
    if (at_end < 0) to = std::min(to, at_start / (at_start - at_end));
    return from <= to;
}

glm::vec4 to_texels(const LightView& view, const glm::dvec4& point_lc, bool foreshortened) {
    const glm::dvec3 ndc = glm::dvec3(point_lc) / point_lc.w;
    const double width = foreshortened && view.perspective ? std::min(1.0, view.near_ls / point_lc.w) : 1.0;
    return glm::vec4(
        glm::dvec4((glm::dvec2(ndc) + 1.0) * (0.5 * view.size_texels), std::clamp(ndc.z, 0.0, 1.0), width));
}

struct InstanceEdges {
    std::uint32_t instance = 0;
    std::vector<SilhouetteEdge> edges;
};

std::vector<InstanceEdges> find_by_instance(Engine& engine, const Scene& scene, const LightSample& sample,
                                            const SilhouetteOptions& options) {
    std::set<std::uint32_t> casters;
    for (const LightView& view : sample.views) casters.insert(view.casters.begin(), view.casters.end());
    std::vector<InstanceEdges> found;
    std::map<std::uint32_t, MeshEdges> meshes;
    for (const std::uint32_t instance : casters) {
        const std::uint32_t mesh = scene.instances[instance].mesh;
        if (!meshes.contains(mesh)) {
            engine.check_cancelled();
            meshes[mesh] = engine.mesh_data().get_edges(*scene.meshes[mesh], &engine.threads());
        }
        found.push_back({instance, {}});
    }
    const LightPoint light =
        sample.directional ? LightPoint(sample.to_light_ws, 0.0) : LightPoint(sample.position_ws, 1.0);
    const auto find_one = [&](InstanceEdges& item, ThreadPool* threads) {
        const Instance& instance = scene.instances[item.instance];
        item.edges = find_silhouettes(*scene.meshes[instance.mesh], meshes.at(instance.mesh),
                                      instance.world_from_object, light, options, threads);
    };
    // Few instances are likely large ones: share each between the threads. Of many, give each thread its own.
    if (found.size() < 8) {
        for (InstanceEdges& item : found) {
            engine.check_cancelled();
            find_one(item, &engine.threads());
        }
    } else {
        engine.threads().parallel_for(found.size(), 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end && !engine.cancel_token().requested(); ++i) find_one(found[i], nullptr);
        });
    }
    engine.check_cancelled();
    return found;
}

std::vector<MapEdge> project_to_view(Engine& engine, const Scene& scene, const std::vector<InstanceEdges>& found,
                                     const LightView& view, const MapEdgeOptions& options) {
    std::vector<std::uint8_t> wanted(scene.instances.size(), 0);
    for (const std::uint32_t instance : view.casters) wanted[instance] = 1;
    std::vector<std::vector<MapEdge>> parts(found.size());
    engine.threads().parallel_for(found.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!wanted[found[i].instance] || engine.cancel_token().requested()) continue;
            const Instance& instance = scene.instances[found[i].instance];
            const Mesh& mesh = *scene.meshes[instance.mesh];
            const glm::dmat4 lc_from_object = view.lc_from_ws * instance.world_from_object;
            parts[i].reserve(found[i].edges.size());
            for (const SilhouetteEdge& edge : found[i].edges) {
                const glm::dvec4 a = lc_from_object * glm::dvec4(glm::dvec3(mesh.positions[edge.a]), 1.0);
                const glm::dvec4 b = lc_from_object * glm::dvec4(glm::dvec3(mesh.positions[edge.b]), 1.0);
                MapEdge projected;
                if (project_edge(view, a, b, options.half_width_texels, options.foreshortened, projected))
                    parts[i].push_back(projected);
            }
        }
    });
    engine.check_cancelled();
    std::size_t total = 0;
    for (const auto& part : parts) total += part.size();
    std::vector<MapEdge> edges;
    edges.reserve(total);
    for (const auto& part : parts) edges.insert(edges.end(), part.begin(), part.end());
    return edges;
}

}  // namespace

bool project_edge(const LightView& view, glm::dvec4 start_lc, glm::dvec4 end_lc, double half_width_texels,
                  bool foreshortened, MapEdge& result) {
    const double rim = 1.0 + 2.0 * half_width_texels / view.size_texels;
    const double least_w = view.perspective ? 1e-4 * view.near_ls : 0.5;
    double from = 0, to = 1;
    if (!cut(start_lc.w - least_w, end_lc.w - least_w, from, to)) return false;
    if (!cut(start_lc.z, end_lc.z, from, to)) return false;  // beyond the far plane no receiver lies
    for (int axis = 0; axis < 2; ++axis) {
        if (!cut(rim * start_lc.w + start_lc[axis], rim * end_lc.w + end_lc[axis], from, to)) return false;
        if (!cut(rim * start_lc.w - start_lc[axis], rim * end_lc.w - end_lc[axis], from, to)) return false;
    }
    // An end that is not cut keeps its bits, so that edges that share a vertex share it in the map.
    const glm::dvec4 start = from > 0 ? glm::mix(start_lc, end_lc, from) : start_lc;
    const glm::dvec4 end = to < 1 ? glm::mix(start_lc, end_lc, to) : end_lc;
    result = {to_texels(view, start, foreshortened), to_texels(view, end, foreshortened)};
    return true;
}

MapEdges find_map_edges(Engine& engine, const Scene& scene, const LightSample& sample, const MapEdgeOptions& options) {
    const auto timer = engine.time_stage("silhouettes");
    MapEdges result;
    const std::vector<InstanceEdges> found = find_by_instance(engine, scene, sample, options.silhouettes);
    for (const InstanceEdges& item : found) result.silhouette_edges += std::int64_t(item.edges.size());
    for (const LightView& view : sample.views)
        result.by_view.push_back(project_to_view(engine, scene, found, view, options));
    return result;
}

}  // namespace shadow_layers
