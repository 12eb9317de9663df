// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/light_cache.h"

#include "lights/light_shape.h"

namespace shadow_layers {

void LightCache::begin_sample(const Frame& frame) {
    frame_ = &frame;
    ++picture_sample_;
}

LightSamples LightCache::get(std::uint32_t light, const TechniqueNeeds& needs) {
    // Lists of casters are long in large scenes: 500 lights must not hold theirs at once.
    if (!keeps_) std::erase_if(entries_, [&](const auto& item) { return item.first.light != light; });
    const Key key{light, needs.map_size, needs.map_border_texels, needs.separate_samples(), needs.light_pattern};
    const auto [found, is_new] = entries_.try_emplace(key);
    Entry& entry = found->second;
    if (is_new) {
        entry.points = sample_light_shape(frame_->scene->lights[light], key.count, key.pattern);
        entry.held.resize(entry.points.size());
    }
    return {int(entry.points.size()),
            [this, key, &entry](int index) { return get_sample(key, entry, std::size_t(index)); }};
}

std::shared_ptr<const LightSample> LightCache::get_sample(const Key& key, Entry& entry, std::size_t index) {
    Held& held = entry.held[index];
    if (held.picture_sample == picture_sample_) return held.sample;
    const auto timer = engine_.time_stage("light_views");
    const auto sample = std::make_shared<const LightSample>(
        fit_light_views(*frame_, frame_->scene->lights[key.light], entry.points[index],
                        {key.map_size, key.border_texels}, held.sample.get(), &engine_.threads()));
    // Nor the views of 256 samples.
    if (keeps_ || entry.points.size() == 1) held = {picture_sample_, sample};
    return sample;
}

void LightCache::forget(std::uint32_t light) {
    std::erase_if(entries_, [&](const auto& item) { return item.first.light == light; });
}

}  // namespace shadow_layers
