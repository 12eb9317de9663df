// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "lights/light_views.h"

namespace shadow_layers {

/// How a pixel stands to a light before any occlusion. The first that holds, in this order, wins: a receiver outside
/// the cone is 1 whether or not its face is turned away.
enum class Facing : std::uint8_t {
    Background,   ///< no receiver, or a holdout
    OutsideCone,  ///< outside the spot's cone, or not in front of an area light
    Unlinked,     ///< the receiver's group is not in the light's receiver_set
    TurnedAway,   ///< the side that the camera sees is not turned to the light (edge-on counts as turned away)
    Lit,          ///< visibility is decided by what lies between
};

/// Visibility where nothing occludes: 0 on faces turned away, else 1.
inline float get_unoccluded_visibility(Facing facing) { return facing == Facing::TurnedAway ? 0.0f : 1.0f; }

/// The rule for one frame and one light position, in double. THE place that defines it: shaders/lib mirrors it.
class FacingRule {
public:
    /// Both arguments must outlive the rule.
    FacingRule(const Frame& frame, const Light& light, const LightPosition& position);

    Facing classify(std::size_t pixel) const;

    /// From the receiver to the light: a unit vector for a sun, else the unscaled difference.
    glm::dvec3 get_to_light(std::size_t pixel) const {
        return directional_ ? to_light_ : light_rel_ - glm::dvec3(frame_.positions_rel[pixel]);
    }
    /// Is the direction inside the cone (half-space of an area light)? The rim is inside. Decided by the way across
    /// the axis, not by the cosine: a spot as narrow as 1e-6 keeps its rim. `slack` widens the cone by that part of it,
    /// so that who computes in float never sees a pixel that a fit left out.
    bool is_in_cone(const glm::dvec3& to_light, double slack = 0) const {
        if (cone_cos_ <= -1) return true;
        const glm::dvec2 across(glm::dot(axes_[0], to_light), glm::dot(axes_[1], to_light));
        const double along = glm::dot(axes_[2], to_light);
        return glm::length(across) * cone_cos_ <= (along + slack * glm::length(to_light)) * cone_sin_;
    }
    bool is_linked(std::uint32_t instance) const;
    /// What this position of the light brings to a pixel that it lights, against the light's other positions: by the
    /// cosine at the receiver; of an area light also by that at the light and by the distance.
    double get_weight(std::size_t pixel) const;

private:
    const Frame& frame_;
    const Light& light_;
    bool directional_;
    double cone_cos_, cone_sin_;
    glm::dmat3 axes_;
    glm::dvec3 to_light_, light_rel_;
};

/// The layer of a light that casts no shadows: get_unoccluded_visibility of every pixel. Of many positions those that
/// light the pixel decide: what a part of the light shines on is in no shadow, though it is turned from the rest.
void fill_unoccluded_visibility(const Frame& frame, const Light& light, std::span<const LightPosition> positions,
                                std::span<float> visibility, ThreadPool* threads = nullptr);

}  // namespace shadow_layers
