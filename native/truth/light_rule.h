// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "frame/frame.h"
#include "lights/light_views.h"
#include "shadow_layers/scene.h"

namespace shadow_layers::truth {

/// A place on a triangle that the camera sees.
struct Receiver {
    PixelIds ids;
    glm::dvec3 place_ws{0.0};
    glm::dvec3 normal{0.0};      ///< of the triangle's plane: unit, to the side that the camera sees
    double camera_distance = 0;  ///< scene units
    double slack = 0;            ///< how far the place may be off by the rounding of double arithmetic, scene units
    bool certain = true;         ///< false: the ray runs so nearly along the plane that the place is a convention
};

/// Does the instance cast shadows for this light?
inline bool may_cast(const Light& light, const Instance& instance) {
    return (instance.flags & kInstanceShadow) && (light.blocker_set >> instance.blocker_group & 1u);
}

/// What decides a receiver's visibility under a light, before what lies between them is looked at.
enum class Standing : std::uint8_t {
    Apart,       ///< outside of the light's cone, behind an area light, or not linked to the light: 1
    TurnedAway,  ///< the side that the camera sees is not turned to the light: 0
    Facing       ///< what lies between
};

/// A standing, and all those that a program could find which keeps places and normals in float.
struct Standings {
    Standing decided = Standing::Apart;
    bool may_be_apart = false, may_be_turned_away = false, may_be_facing = false;
};

/// A direction in the space of a spot's own scale, where its cone is round about the same axis; of other lights as it
/// is.
glm::dvec3 undo_spot_scale(const Light& light, const glm::dvec3& direction);

/// The definition of how receivers stand to one sample of a light, from the light's own description: angles, and
/// the plane of the receiver's triangle. Shares no formula with the product's own rule.
class LightRule {
public:
    /// All must outlive the rule.
    LightRule(const Scene& scene, const Light& light, const LightSample& sample);

    Standings find_standings(const Receiver& receiver) const;
    Standing find_standing(const Receiver& receiver) const { return find_standings(receiver).decided; }
    /// Is the place inside of the cone (an area light: the half-space before it)? The rim is inside.
    bool is_in_cone(const glm::dvec3& place_ws) const { return find_angle(place_ws) <= half_angle_; }
    /// From the place to the light: a unit vector for a sun, else the difference.
    glm::dvec3 find_to_light(const glm::dvec3& place_ws) const;
    /// The light that this sample brings to a receiver that it lights, next to the light's other samples: by the cosine
    /// at the receiver; of an area light also by that at the light and the inverse square of the distance.
    double compute_weight(const Receiver& receiver) const;
    /// How far the weight of a program may be off that keeps places and normals in float.
    double find_weight_error(const Receiver& receiver) const;

    bool is_linked(std::uint32_t instance) const;

private:
    double find_angle(const glm::dvec3& place_ws) const;
    double compute_falloff(const glm::dvec3& to_light) const;
    double find_float_error(const Receiver& receiver) const;

    const Scene& scene_;
    const Light& light_;
    const LightSample& sample_;
    glm::dvec3 backward_;  ///< unit, against the light's direction
    double half_angle_;    ///< of the cone, radians
};

}  // namespace shadow_layers::truth
