// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "engine/engine.h"
#include "lights/light_views.h"
#include "scene/adjacency.h"
#include "scene/silhouettes.h"
#include "techniques/extsm/extended_map.h"

namespace shadow_layers {

/// The two facets of a silhouette edge by their outward unit normals. A boundary counts as a sheet that is folded back
/// onto itself.
struct EdgeFacets {
    glm::dvec3 lit{0.0}, dark{0.0};  ///< the light is before the first and behind the second
    glm::dvec3 away{0.0};            ///< unit, across the edge, out of the caster; for facets that are folded together
};

/// From the edge a-b and its apexes `c` and `d` as in SilhouetteEdge (`d` null: boundary), all in one rigid space.
EdgeFacets find_facets(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, const glm::dvec3* d);

/// The direction in which a quad is extruded, [Bujnak04] 4.1: halfway between the two outward normals. If the facets
/// meet at less than 90 degrees, a bevel is put between them and the quad spans from the bevel to one facet: the one
/// that together with it makes a silhouette.
struct Extrusion {
    glm::dvec3 direction{0.0};  ///< unit
    bool bevelled = false;
};
/// `to_light`: from the edge, of any length. Without `split` there is never a bevel.
Extrusion find_extrusion(const EdgeFacets& facets, glm::dvec3 to_light, bool split = true);

/// An edge in light clip space to a quad in the map. The extrusion is as long as would make the quad kQuadWidthTexels
/// wide were it seen squarely, so what foreshortening leaves of it is the quad's width (at least 0.7 of that for an
/// edge of two facets). Returns false where nothing of the edge is near the map.
bool make_quad(const LightView& view, glm::dvec4 start_lc, glm::dvec4 end_lc, glm::dvec3 extrusion_ws,
               ExtendedQuad& quad);

/// Quads of all casters for each view of a light sample.
struct ExtendedQuads {
    std::vector<std::vector<ExtendedQuad>> by_view;  ///< in the order of instances and of their edges
    std::int64_t silhouette_edges = 0;               ///< found, before any view cuts them
    std::int64_t bevelled_edges = 0;                 ///< of facets at less than 90 degrees
};
ExtendedQuads find_extended_quads(Engine& engine, const Scene& scene, const LightSample& sample);

}  // namespace shadow_layers
