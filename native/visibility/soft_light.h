// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "frame/frame.h"
#include "lights/facing.h"
#include "lights/light_views.h"

namespace shadow_layers {

/// The samples of a light as all receivers share them, and quick answers about them all at once. With shifted patterns
/// there are several such lists of samples, of which a receiver takes one.
class SoftLight {
public:
    /// `sample_lists`: not empty, all of the same length.
    SoftLight(const Frame& frame, const Light& light, std::vector<std::vector<LightSample>> sample_lists);

    std::size_t list_count() const { return lists_.size(); }
    const std::vector<LightSample>& samples(std::size_t list) const { return lists_[list]; }
    std::size_t sample_count() const { return lists_.front().size(); }
    const LightSample& centre() const { return centre_; }
    /// Of the ball about the centre that holds all samples; of a sun's: of their unit vectors.
    double radius() const { return radius_; }

    bool is_candidate(std::size_t pixel) const { return centre_rule_.is_candidate(pixel); }

    /// What holds for the samples of every list; `Some`: it differs, or lies too near to tell.
    enum class Which : std::uint8_t { All, None, Some };
    /// How a candidate stands to them.
    struct Stance {
        Which in_cone, turned_to;
        bool is_lit_by_all() const { return in_cone == Which::All && turned_to == Which::All; }
        /// Nothing that may lie between can change this receiver's visibility: 1 outside the cone, 0 turned away.
        bool is_decided() const {
            return in_cone == Which::None || (in_cone == Which::All && turned_to == Which::None);
        }
        float get_decided() const { return in_cone == Which::None ? 1.0f : 0.0f; }
    };
    Stance find_stance(std::size_t pixel) const;

    /// One sample of a list, by the rule in double.
    Facing classify(std::size_t list, std::size_t sample, std::size_t pixel) const {
        return rules_[list][sample].classify(pixel);
    }

private:
    std::vector<std::vector<LightSample>> lists_;
    LightSample centre_;
    FacingRule centre_rule_;
    std::vector<std::vector<FacingRule>> rules_;
    const Frame& frame_;
    double radius_ = 0;
    double cone_reach_ = 0;  ///< along the cone's axis and across it
};

}  // namespace shadow_layers
