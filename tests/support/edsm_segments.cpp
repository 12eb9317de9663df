// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/edsm_segments.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "scene/mesh_data_cache.h"
#include "scene/silhouettes.h"

namespace shadow_layers::testing {
namespace {

/// Keeps the part of the segment where `at_start` to `at_end`, linear between, is not negative.
bool cut(EdgeSegment& segment, double at_start, double at_end) {
    if (at_start < 0 && at_end < 0) return false;
    const double f = at_start / (at_start - at_end);
    const glm::dvec3 middle = at_start < 0 || at_end < 0 ? glm::mix(segment.start, segment.end, f) : glm::dvec3(0);
    if (at_start < 0) segment.start = middle, segment.starts = false;
    if (at_end < 0) segment.end = middle, segment.ends = false;
    return true;
}

double distance_to(glm::dvec2 point, const EdgeSegment& segment) {
    const glm::dvec2 start(segment.start), along = glm::dvec2(segment.end) - start;
    const double length2 = glm::dot(along, along);
    const double f = length2 > 0 ? std::clamp(glm::dot(point - start, along) / length2, 0.0, 1.0) : 0.0;
    return glm::distance(point, start + f * along);
}

/// One end of both, or one over the other.
bool are_joined(const EdgeSegment& a, const EdgeSegment& b) {
    for (const auto& [own, p] : {std::pair(a.starts, a.start), {a.ends, a.end}})
        for (const auto& [other, q] : {std::pair(b.starts, b.start), {b.ends, b.end}})
            if (own && other && glm::distance(glm::dvec2(p), glm::dvec2(q)) < kSamePlace) return true;
    const auto lies_on = [](const EdgeSegment& one, const EdgeSegment& line) {
        return distance_to(one.start, line) < kBesideEdge && distance_to(one.end, line) < kBesideEdge;
    };
    return lies_on(a, b) || lies_on(b, a);
}

/// An edge of a mesh in a view's map, cut before the light. False if it lies behind the light.
bool project(const LightView& view, glm::dvec4 start_lc, glm::dvec4 end_lc, EdgeSegment& segment) {
    const double least_w = view.perspective ? 1e-6 * view.near_ls : 0.5;
    if (start_lc.w < least_w && end_lc.w < least_w) return false;
    const glm::dvec4 middle = glm::mix(start_lc, end_lc, (least_w - start_lc.w) / (end_lc.w - start_lc.w));
    if (start_lc.w < least_w) start_lc = middle, segment.starts = false;
    if (end_lc.w < least_w) end_lc = middle, segment.ends = false;
    const auto place = [&](const glm::dvec4& lc) {
        return glm::dvec3((glm::dvec2(lc) / lc.w + 1.0) * (0.5 * view.size_texels), lc.z / lc.w);
    };
    segment.start = place(start_lc), segment.end = place(end_lc);
    return true;
}

}  // namespace

bool cut_at_square(EdgeSegment& segment, glm::dvec2 low, double side) {
    for (int axis = 0; axis < 2; ++axis) {
        const double edges[2] = {low[axis], low[axis] + side};
        if (!cut(segment, segment.start[axis] - edges[0], segment.end[axis] - edges[0])) return false;
        if (!cut(segment, edges[1] - segment.start[axis], edges[1] - segment.end[axis])) return false;
    }
    return true;
}

int count_chains(const std::vector<EdgeSegment>& segments) {
    std::vector<std::size_t> chain(segments.size());
    std::iota(chain.begin(), chain.end(), 0);
    for (std::size_t i = 0; i < segments.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (chain[i] != chain[j] && are_joined(segments[i], segments[j])) {
                const std::size_t joined = chain[i], other = chain[j];
                std::replace(chain.begin(), chain.end(), joined, other);
            }
    return int(std::set<std::size_t>(chain.begin(), chain.end()).size());
}

std::vector<EdgeSegment> find_edge_segments(const Scene& scene, const LightSample& position, const LightView& view,
                                            ThreadPool& threads) {
    const LightPoint light =
        position.directional ? LightPoint(position.to_light_ws, 0.0) : LightPoint(position.position_ws, 1.0);
    MeshDataCache mesh_data(std::size_t{512} << 20);
    std::vector<EdgeSegment> segments;
    for (const std::uint32_t index : view.casters) {
        const Instance& instance = scene.instances[index];
        const Mesh& mesh = *scene.meshes[instance.mesh];
        const glm::dmat4 lc_from_object = view.lc_from_ws * instance.world_from_object;
        const auto to_lc = [&](std::uint32_t vertex) {
            return lc_from_object * glm::dvec4(glm::dvec3(mesh.positions[vertex]), 1.0);
        };
        const auto found =
            find_silhouettes(mesh, mesh_data.get_edges(mesh, &threads), instance.world_from_object, light);
        for (const SilhouetteEdge& edge : found) {
            EdgeSegment segment;
            if (project(view, to_lc(edge.a), to_lc(edge.b), segment) &&
                cut_at_square(segment, glm::dvec2(0), view.size_texels))
                segments.push_back(segment);
        }
    }
    return segments;
}

}  // namespace shadow_layers::testing
