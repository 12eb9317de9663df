// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/facing.h"

#include "base/thread_pool.h"
#include "light_weight.h"

namespace shadow_layers {

FacingRule::FacingRule(const ReceiverSource& receivers, const Light& light, const LightSample& sample)
    : receivers_(receivers), light_(light), centre_rel_(glm::dvec3(light.world_from_light[3]) - receivers.origin_ws) {
    const glm::dvec3 place = sample.position_ws - receivers.origin_ws;
    source_.directional = sample.directional;
    source_.cone_cos = sample.cone_cos;
    source_.cone_sin = sample.cone_sin;
    for (int axis = 0; axis < 2; ++axis) source_.cone_shrink[axis] = 1 / sample.cone_scale[axis];
    for (int i = 0; i < 3; ++i) {
        source_.to_light[i] = sample.to_light_ws[i];
        source_.place[i] = place[i];
        for (int axis = 0; axis < 3; ++axis) source_.axes[axis][i] = sample.axes_ws[axis][i];
    }
}

double FacingRule::get_weight(std::size_t pixel) const {
    const glm::dvec3 to_light = get_to_light(pixel);
    const double up = glm::dot(glm::dvec3(receivers_.normals[pixel]), to_light);
    const glm::dvec3 axis(source_.axes[2][0], source_.axes[2][1], source_.axes[2][2]);
    const double centre_apart = glm::distance(centre_rel_, glm::dvec3(receivers_.positions_rel[pixel]));
    return find_light_weight(up, glm::length(to_light), light_.kind == LightKind::Area, glm::dot(axis, to_light),
                             centre_apart);
}

void fill_unoccluded_visibility(const ReceiverSource& receivers, const Light& light,
                                std::span<const LightSample> samples, std::span<float> visibility,
                                ThreadPool* threads) {
    std::vector<FacingRule> rules;
    for (const LightSample& sample : samples) rules.emplace_back(receivers, light, sample);
    const auto fill = [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            float sum = 0;
            bool is_lit = rules.empty();
            for (const FacingRule& rule : rules) {
                const Facing facing = rule.classify(pixel);
                sum += get_unoccluded_visibility(facing);
                is_lit = is_lit || facing == Facing::Undecided;
            }
            visibility[pixel] = is_lit ? 1.0f : sum / float(rules.size());
        }
    };
    if (threads)
        threads->parallel_for(receivers.count(), 1 << 14, fill);
    else
        fill(0, receivers.count());
}

}  // namespace shadow_layers
