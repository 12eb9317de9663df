// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/soft_light.h"

#include <algorithm>
#include <cmath>

#include "lights/light_shape.h"

namespace shadow_layers {
namespace {

// Of the light's distance: more than all roundings of positions, normals and this arithmetic.
constexpr double kSlack = 1e-5;

}  // namespace

SoftLight::SoftLight(const Frame& frame, const Light& light, std::vector<std::vector<LightSample>> sample_lists)
    : lists_(std::move(sample_lists)),
      centre_(sample_light_shape(light, 1).front()),
      centre_rule_(frame, light, centre_),
      frame_(frame) {
    for (const std::vector<LightSample>& list : lists_) {
        std::vector<FacingRule>& rules = rules_.emplace_back();
        for (const LightSample& sample : list) {
            rules.emplace_back(frame, light, sample);
            radius_ = std::max(radius_, centre_.directional ? glm::distance(sample.to_light_ws, centre_.to_light_ws)
                                                            : glm::distance(sample.position_ws, centre_.position_ws));
        }
    }
    // An area light's samples lie in the plane that bounds its half-space.
    cone_reach_ = light.kind == LightKind::Area ? 0 : radius_;
}

SoftLight::Stance SoftLight::find_stance(std::size_t pixel) const {
    const auto decide = [](double value, double reach) {
        return value - reach > 0 ? Which::All : value + reach < 0 ? Which::None : Which::Some;
    };
    const glm::dvec3 to_light = centre_rule_.get_to_light(pixel);
    const double slack = kSlack * (glm::length(to_light) + radius_);
    Stance stance{Which::All, decide(glm::dot(glm::dvec3(frame_.normals[pixel]), to_light), radius_ + slack)};
    if (centre_.cone_cos > -1) {
        const facing::Source& source = centre_rule_.source();
        const auto parts = facing::find_cone_parts<double>(source, {to_light.x, to_light.y, to_light.z});
        const double inside = parts.along * centre_.cone_sin - parts.across * centre_.cone_cos;
        stance.in_cone = decide(inside, (cone_reach_ + slack) * facing::find_cone_stretch(source));
    }
    return stance;
}

}  // namespace shadow_layers
