// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/adjacency.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

class ThreadPool;

/// A light as a homogeneous point: (position, 1), or (direction towards the light, 0) for a sun.
using LightPoint = glm::dvec4;

/// An edge at which the number of triangles between the light and what lies behind changes.
///
/// Seen from the light (in world space, mirrored instances included) the triangles at the edge cover its *left* side,
/// going from a to b: (b - a) x (c - a) points towards the light. For a fan with triangles on both sides the left side
/// holds more of them.
struct SilhouetteEdge {
    std::uint32_t a = 0, b = 0;  ///< vertex numbers of the mesh (welded ones)
    std::uint32_t c = 0;  ///< apex of a triangle on the left; if the winding is consistent, of the one facing the light
    std::uint32_t d = kNoVertex;  ///< apex of another on the left; kNoVertex at a boundary
    std::int16_t multiplicity =
        1;                     ///< triangles on the left minus those on the right: > 0 (algorithms: signed edge sums)
    std::uint8_t concave = 0;  ///< 1: the part is closed, and the light grazes this edge from inside the solid, so that
                               ///< what lies behind is in shadow on both sides: no shadow border. May be skipped.
    std::uint8_t two_sided =
        0;  ///< 1: a fan with triangles on the right too: the shadow goes on there. May be skipped.
};

struct SilhouetteOptions {
    bool skip_concave = false;    ///< leave out edges with `concave`
    bool skip_two_sided = false;  ///< leave out edges with `two_sided`
};

/// The silhouette edges of one instance, in the order of the mesh's edges whatever the number of threads.
///
/// Facing is decided by each triangle's winding in double, as det(M) * (object space side), through the adjugate of the
/// instance's matrix: mirrored, sheared and flattened (singular) instances need no inverse and no stored normal. A
/// triangle with the light in its plane counts as facing. Windings need not agree between triangles: an edge is a
/// silhouette if, with every triangle turned towards the light, the ways they run along it do not cancel. Triangles
/// without area are as if they were not there. Closed manifold: one neighbour faces the light, the other does not.
/// Boundary edges always are silhouettes.
std::vector<SilhouetteEdge> find_silhouettes(const Mesh& mesh, const MeshEdges& edges,
                                             const glm::dmat4& world_from_object, const LightPoint& light_ws,
                                             const SilhouetteOptions& options = {}, ThreadPool* threads = nullptr);

/// The light in the instance's object space, up to a positive factor: adj(M) (l - w t) and w det(M). Usable for
/// singular matrices. Side of a triangle with corner v and winding normal n: sign of dot(xyz - w * v, n), as in world
/// space.
glm::dvec4 compute_light_in_object(const glm::dmat4& world_from_object, const LightPoint& light_ws);

}  // namespace shadow_layers
