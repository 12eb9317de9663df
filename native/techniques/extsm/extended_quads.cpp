// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/extsm/extended_quads.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "stages/map_edges.h"

namespace shadow_layers {
namespace {

/// A unit vector, or zero for a vector without direction.
template <class V>
V direction_of(V v) {
    const double len = glm::length(v);
    return len > 0 && std::isfinite(len) ? v / len : V(0.0);
}

glm::dvec2 turn_left(glm::dvec2 v) { return {-v.y, v.x}; }

/// Places in the map's plane: (x, y) / -z, or (x, y) of a view that isn't perspective.
class MapPlane {
public:
    explicit MapPlane(const LightView& view)
        : perspective_(view.perspective),
          axes_(view.ls_from_ws),
          texels_per_unit_(0.5 * view.size_texels * view.lc_from_ls[0][0],
                           0.5 * view.size_texels * view.lc_from_ls[1][1]),
          half_texels_(0.5 * view.size_texels),
          shift_(view.lc_from_ls[2]) {}

    /// How a step in world space moves a point that is seen at `texel`, times the point's distance along the view.
    glm::dvec2 move(glm::dvec2 texel, glm::dvec3 step_ws) const {
        const glm::dvec3 step = axes_ * step_ws;
        if (!perspective_) return step;
        const glm::dvec2 place = (texel - half_texels_ + shift_ * half_texels_) / texels_per_unit_;
        return glm::dvec2(step) + place * step.z;
    }
    const glm::dvec2& texels_per_unit() const { return texels_per_unit_; }

private:
    bool perspective_;
    glm::dmat3 axes_;
    glm::dvec2 texels_per_unit_;
    double half_texels_;
    glm::dvec2 shift_;  // of the projection's centre, in normalised coordinates
};

/// Where texels are not square, lengths are kept across the edge.
glm::dvec2 step_outward(const MapPlane& plane, glm::dvec2 texel, glm::dvec2 along_texels, glm::dvec3 extrusion_ws) {
    const glm::dvec2 move = plane.move(texel, extrusion_ws);
    const glm::dvec2 move_texels = move * plane.texels_per_unit();
    const glm::dvec2 left_texels = turn_left(direction_of(along_texels));
    if (left_texels == glm::dvec2(0.0)) return direction_of(move_texels) * std::min(1.0, glm::length(move));
    const double width = std::abs(glm::dot(move, turn_left(direction_of(along_texels / plane.texels_per_unit()))));
    const double width_texels = glm::dot(move_texels, left_texels);
    // Two facets leave 0.7 of the width; less comes of fans and of rounding, which take the way across the edge.
    constexpr double kLeastWidth = 0.5, kSteepest = 1e-6;
    if (!(width >= kLeastWidth) || std::abs(width_texels) <= kSteepest * glm::length(move_texels)) return -left_texels;
    // The caster lies on the left (scene/silhouettes.h).
    return move_texels * (-width / width_texels);
}

struct InstanceQuads {
    std::uint32_t instance = 0;
    std::vector<SilhouetteEdge> edges;
    std::vector<glm::dvec3> extrusions_ws;
};

std::int64_t find_extrusions(const Scene& scene, const LightPoint& light, InstanceQuads& item) {
    const Instance& instance = scene.instances[item.instance];
    const Mesh& mesh = *scene.meshes[instance.mesh];
    const auto place = [&](std::uint32_t vertex) {
        return glm::dvec3(instance.world_from_object * glm::dvec4(glm::dvec3(mesh.positions[vertex]), 1.0));
    };
    std::int64_t bevelled = 0;
    for (const SilhouetteEdge& edge : item.edges) {
        const glm::dvec3 a = place(edge.a);
        const glm::dvec3 d = edge.d == kNoVertex ? a : place(edge.d);
        const EdgeFacets facets = find_facets(a, place(edge.b), place(edge.c), edge.d == kNoVertex ? nullptr : &d);
        const Extrusion extrusion = find_extrusion(facets, glm::dvec3(light) - light.w * a);
        item.extrusions_ws.push_back(extrusion.direction);
        bevelled += extrusion.bevelled;
    }
    return bevelled;
}

}  // namespace

EdgeFacets find_facets(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, const glm::dvec3* d) {
    EdgeFacets facets;
    // Both products point to the light's side, of whichever way the facets are wound.
    const glm::dvec3 along = direction_of(b - a);
    const glm::dvec3 by_c = direction_of(glm::cross(along, c - a));
    facets.away = -direction_of((c - a) - along * glm::dot(along, c - a));
    if (!d) return {by_c, -by_c, facets.away};
    const glm::dvec3 by_d = direction_of(glm::cross(along, *d - a));
    facets.away = direction_of(facets.away - direction_of((*d - a) - along * glm::dot(along, *d - a)));
    // The lit facet has the other one behind it: the edge is convex.
    const bool c_is_lit = glm::dot(by_c, *d - a) <= 0;
    facets.lit = c_is_lit ? by_c : by_d;
    facets.dark = c_is_lit ? -by_d : -by_c;
    return facets;
}

Extrusion find_extrusion(const EdgeFacets& facets, glm::dvec3 to_light, bool split) {
    constexpr double kFolded = 1e-6;
    const glm::dvec3 sum = facets.lit + facets.dark;
    const glm::dvec3 bevel = glm::length(sum) > kFolded ? direction_of(sum) : facets.away;
    if (!split || glm::dot(facets.lit, facets.dark) >= 0) return {bevel, false};
    const bool bevel_is_lit = glm::dot(bevel, to_light) > 0;
    return {direction_of(bevel + (bevel_is_lit ? facets.dark : facets.lit)), true};
}

bool make_quad(const LightView& view, glm::dvec4 start_lc, glm::dvec4 end_lc, glm::dvec3 extrusion_ws,
               ExtendedQuad& quad) {
    const double kHalfWidthTexels = 2.0 * kTexelDiagonal;
    MapEdge edge;
    if (!project_edge(view, start_lc, end_lc, kHalfWidthTexels, false, edge)) return false;
    const MapPlane plane(view);
    const glm::dvec2 start(edge.start), end(edge.end);
    quad.start = edge.start;
    quad.end = edge.end;
    quad.outward = glm::vec4(glm::dvec4(step_outward(plane, start, end - start, extrusion_ws),
                                        step_outward(plane, end, end - start, extrusion_ws)));
    return true;
}

ExtendedQuads find_extended_quads(Engine& engine, const Scene& scene, const LightSample& sample) {
    const auto timer = engine.time_stage("silhouettes");
    std::set<std::uint32_t> casters;
    for (const LightView& view : sample.views) casters.insert(view.casters.begin(), view.casters.end());
    const LightPoint light =
        sample.directional ? LightPoint(sample.to_light_ws, 0.0) : LightPoint(sample.position_ws, 1.0);
    // What the light grazes from inside a solid, and what another facet carries on, borders no shadow.
    const SilhouetteOptions options{.skip_concave = true, .skip_two_sided = true};
    ExtendedQuads result;
    result.by_view.resize(sample.views.size());
    for (const std::uint32_t number : casters) {
        engine.check_cancelled();
        const Instance& instance = scene.instances[number];
        const Mesh& mesh = *scene.meshes[instance.mesh];
        const MeshEdges mesh_edges = engine.mesh_data().get_edges(mesh, &engine.threads());
        InstanceQuads item{number, {}, {}};
        item.edges = find_silhouettes(mesh, mesh_edges, instance.world_from_object, light, options, &engine.threads());
        result.silhouette_edges += std::int64_t(item.edges.size());
        result.bevelled_edges += find_extrusions(scene, light, item);
        for (std::size_t v = 0; v < sample.views.size(); ++v) {
            const LightView& view = sample.views[v];
            if (!std::binary_search(view.casters.begin(), view.casters.end(), number)) continue;
            const glm::dmat4 lc_from_object = view.lc_from_ws * instance.world_from_object;
            for (std::size_t e = 0; e < item.edges.size(); ++e) {
                const glm::dvec4 a = lc_from_object * glm::dvec4(glm::dvec3(mesh.positions[item.edges[e].a]), 1.0);
                const glm::dvec4 b = lc_from_object * glm::dvec4(glm::dvec3(mesh.positions[item.edges[e].b]), 1.0);
                ExtendedQuad quad;
                if (make_quad(view, a, b, item.extrusions_ws[e], quad)) result.by_view[v].push_back(quad);
            }
        }
    }
    return result;
}

}  // namespace shadow_layers
