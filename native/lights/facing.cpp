// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/facing.h"

#include "base/thread_pool.h"

namespace shadow_layers {

FacingRule::FacingRule(const Frame& frame, const Light& light, const LightPosition& position)
    : frame_(frame),
      light_(light),
      directional_(position.directional),
      cone_cos_(position.cone_cos),
      cone_sin_(position.cone_sin),
      axes_(position.axes_ws),
      to_light_(position.to_light_ws),
      light_rel_(position.position_ws - frame.origin_ws) {}

bool FacingRule::is_linked(std::uint32_t instance) const {
    return (light_.receiver_set >> frame_.scene->instances[instance].receiver_group) & 1u;
}

Facing FacingRule::classify(std::size_t pixel) const {
    if (!frame_.coverage[pixel] || frame_.ids[pixel].instance == kNoId) return Facing::Background;
    const glm::dvec3 to_light = get_to_light(pixel);
    if (!is_in_cone(to_light)) return Facing::OutsideCone;
    if (!is_linked(frame_.ids[pixel].instance)) return Facing::Unlinked;
    return glm::dot(glm::dvec3(frame_.normals[pixel]), to_light) > 0 ? Facing::Lit : Facing::TurnedAway;
}

double FacingRule::get_weight(std::size_t pixel) const {
    const glm::dvec3 to_light = get_to_light(pixel);
    const double apart = glm::length(to_light);
    const double cosine = glm::dot(glm::dvec3(frame_.normals[pixel]), to_light) / apart;
    if (light_.kind != LightKind::Area) return cosine;
    return cosine * glm::dot(axes_[2], to_light) / (apart * apart * apart);
}

void fill_unoccluded_visibility(const Frame& frame, const Light& light, std::span<const LightPosition> positions,
                                std::span<float> visibility, ThreadPool* threads) {
    std::vector<FacingRule> rules;
    for (const LightPosition& position : positions) rules.emplace_back(frame, light, position);
    const auto fill = [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            float sum = 0;
            bool is_lit = rules.empty();
            for (const FacingRule& rule : rules) {
                const Facing facing = rule.classify(pixel);
                sum += get_unoccluded_visibility(facing);
                is_lit = is_lit || facing == Facing::Lit;
            }
            visibility[pixel] = is_lit ? 1.0f : sum / float(rules.size());
        }
    };
    if (threads)
        threads->parallel_for(frame.pixel_count(), 1 << 14, fill);
    else
        fill(0, frame.pixel_count());
}

}  // namespace shadow_layers
