// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Silhouette edges in a light's map, in double: cut, and counted by what hangs together.

#include <glm/glm.hpp>
#include <vector>

#include "lights/light_views.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {
class ThreadPool;
}

namespace shadow_layers::testing {

inline constexpr double kBesideEdge = 1.0 / 256;  ///< texels; what lies so far beside an edge is its one or other side
inline constexpr double kSamePlace = 1e-6;        ///< texels

/// Seen from the light the caster lies on the left of the way from start to end.
struct EdgeSegment {
    glm::dvec3 start{0.0}, end{0.0};  ///< texels, and depth_rz
    bool starts = true, ends = true;  ///< the edge's own ends, not where something cut it

    glm::dvec2 direction() const { return glm::normalize(glm::dvec2(end - start)); }
};

/// Cuts at the square from `low` to `low + side`. False if nothing is left.
bool cut_at_square(EdgeSegment& segment, glm::dvec2 low, double side);

/// How many groups there are of segments that meet at ends of their own, or lie on one another.
int count_chains(const std::vector<EdgeSegment>& segments);

/// The silhouette edges of a view's casters inside its map, borders of shadows or not.
std::vector<EdgeSegment> find_edge_segments(const Scene& scene, const LightSample& position, const LightView& view,
                                            ThreadPool& threads);

}  // namespace shadow_layers::testing
