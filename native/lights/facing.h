// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "frame/receiver_source.h"
#include "lights/facing_formulas.h"
#include "lights/light_views.h"

namespace shadow_layers {

/// How a receiver (a pixel, a point) stands to a light before any occlusion. The first that holds, in this order, wins:
/// a receiver outside the cone is 1 whether or not its face is turned away.
enum class Facing : std::uint8_t {
    Background,   ///< no receiver, or a holdout
    OutsideCone,  ///< outside the spot's cone, or not in front of an area light
    Unlinked,     ///< the receiver's group is not in the light's receiver_set
    TurnedAway,   ///< the side that the camera sees is not turned to the light (edge-on counts as turned away)
    Undecided,    ///< turned to the light: what lies between decides the visibility
};

/// Visibility where nothing occludes: 0 on faces turned away, else 1.
inline float get_unoccluded_visibility(Facing facing) { return facing == Facing::TurnedAway ? 0.0f : 1.0f; }

/// The rule for the receivers of a source and one light sample, in double. THE place that defines it, with
/// facing_formulas.h: shaders/lib mirrors it.
class FacingRule {
public:
    /// `light` and what `receivers` is made of must outlive the rule.
    FacingRule(const ReceiverSource& receivers, const Light& light, const LightSample& sample);

    Facing classify(std::size_t pixel) const {
        if (!is_receiver(pixel)) return Facing::Background;
        const glm::dvec3 to_light = get_to_light(pixel);
        return decide(pixel, is_in_cone(to_light), glm::dot(glm::dvec3(receivers_.normals[pixel]), to_light) > 0);
    }
    /// The same for a caller that has found the receiver's place by facing_formulas.h.
    Facing decide(std::size_t pixel, bool in_cone, bool turned_to_light) const {
        if (!is_receiver(pixel)) return Facing::Background;
        if (!in_cone) return Facing::OutsideCone;
        if (!is_linked(receivers_.ids[pixel].instance)) return Facing::Unlinked;
        return turned_to_light ? Facing::Undecided : Facing::TurnedAway;
    }

    /// A linked receiver: cone and side decide. Others are 1. For a caller that takes many pixels at once.
    bool is_candidate(std::size_t pixel) const {
        return is_receiver(pixel) && is_linked(receivers_.ids[pixel].instance);
    }

    /// From the receiver to the light: a unit vector for a sun, else the unscaled difference.
    glm::dvec3 get_to_light(std::size_t pixel) const {
        const glm::vec3& p = receivers_.positions_rel[pixel];
        const facing::Vector<double> to_light = facing::find_to_light<double>(source_, {p.x, p.y, p.z});
        return {to_light.x, to_light.y, to_light.z};
    }
    /// Is the direction inside the cone (half-space of an area light)? The rim is inside. `slack` widens the cone by
    /// that part of it, so that who computes in float never sees a pixel that a fit left out.
    bool is_in_cone(const glm::dvec3& to_light, double slack = 0) const {
        return source_.cone_cos <= -1 ||
               facing::is_in_cone<double>(source_, {to_light.x, to_light.y, to_light.z}, slack);
    }
    bool is_linked(std::uint32_t instance) const {
        // A free point is in no group, and all lights reach it.
        return light_.receiver_set == kAllGroups || instance == kNoId ||
               ((light_.receiver_set >> receivers_.scene->instances[instance].receiver_group) & 1u);
    }
    /// What this sample of the light brings to a pixel that it lights, against the light's other samples; see
    /// find_light_weight.
    double get_weight(std::size_t pixel) const;
    const facing::Source& source() const { return source_; }

private:
    bool is_receiver(std::size_t pixel) const { return receivers_.is_receiver(pixel); }

    ReceiverSource receivers_;
    const Light& light_;
    facing::Source source_;
    glm::dvec3 centre_rel_;  ///< of the light
};

/// The layer of a light that casts no shadows: get_unoccluded_visibility of every pixel. Of many samples those that
/// light the pixel decide: what a part of the light shines on is in no shadow, though it is turned from the rest.
void fill_unoccluded_visibility(const ReceiverSource& receivers, const Light& light,
                                std::span<const LightSample> samples, std::span<float> visibility,
                                ThreadPool* threads = nullptr);

}  // namespace shadow_layers
