// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/light_cache.h"

namespace shadow_layers {

void LightCache::begin_sample(const Frame& frame) {
    frame_ = &frame;
    ++sample_;
}

std::shared_ptr<const std::vector<LightSample>> LightCache::get(std::uint32_t light, const TechniqueNeeds& needs,
                                                                bool is_last_use) {
    const Key key{light, needs.map_size, needs.map_border_texels, needs.light_samples, needs.light_pattern};
    Entry& entry = entries_[key];
    if (entry.sample != sample_) {
        const auto timer = engine_.time_stage("light_views");
        const ViewSettings settings{needs.map_size, needs.map_border_texels, needs.light_samples, needs.light_pattern};
        entry.positions = std::make_shared<const std::vector<LightSample>>(make_light_samples(
            *frame_, frame_->scene->lights[light], settings, entry.positions ? entry.positions.get() : nullptr,
            &engine_.threads(), &engine_.cancel_token()));
        entry.sample = sample_;
    }
    const auto positions = entry.positions;
    // Lists of casters are long in large scenes: 500 lights must not hold theirs at once.
    if (is_last_use || !many_samples_)
        std::erase_if(entries_,
                      [&](const auto& item) { return item.first.light == light ? is_last_use : !many_samples_; });
    return positions;
}

}  // namespace shadow_layers
