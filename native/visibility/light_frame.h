// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "lights/light_views.h"

namespace shadow_layers {

/// The axes in which soft visibility works a light for a part of its receivers: w points from them towards the light.
/// Positions are relative to `origin_rel`, which lies among the receivers.
struct LightFrame {
    bool directional = false;
    glm::dmat3 axes{1.0};        ///< columns u, v, w in world space
    glm::dvec3 origin_rel{0.0};  ///< relative to the picture's origin, world axes
    glm::dvec3 centre{0.0};      ///< of the light, in this frame; unused for a sun
    int face = -1;               ///< of a cube about the light: only receivers in that direction; -1: all

    glm::dvec3 from_rel(const glm::dvec3& position_rel) const { return (position_rel - origin_rel) * axes; }
    glm::dvec3 turn(const glm::dvec3& direction) const { return direction * axes; }
    /// Affine, from world space.
    glm::dmat4 from_world(const glm::dvec3& picture_origin_ws) const;
};

/// Frames for a light, their origins not yet set: one along the axis of a sun, an area light or a narrow spot; else
/// six, the faces of a cube about it. `centre`: the light's sample in its middle.
std::vector<LightFrame> make_light_frames(const Light& light, const LightSample& centre,
                                          const glm::dvec3& picture_origin_ws);

/// Turns a frame about w so that most of the casters' long edges run along u or v, as far as they agree: the boxes
/// round walls, columns and beams are then thin. Looks at some triangles of some casters.
void align_with_edges(const Scene& scene, const Light& light, LightFrame& frame);

}  // namespace shadow_layers
