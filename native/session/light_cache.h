// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "engine/engine.h"
#include "lights/light_views.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// Light positions of the current sample, shared by the techniques that want the same views. For renders of many
/// samples those of the sample before are kept, so that still lights keep their views and so their maps.
class LightCache {
public:
    LightCache(Engine& engine, bool many_samples) : engine_(engine), many_samples_(many_samples) {}

    void begin_sample(const Frame& frame);
    /// `is_last_use`: no later job of this render wants this light; it is forgotten after.
    std::shared_ptr<const std::vector<LightSample>> get(std::uint32_t light, const TechniqueNeeds& needs,
                                                        bool is_last_use);
    void clear() { entries_.clear(); }

private:
    struct Key {
        std::uint32_t light;
        int map_size, border_texels, position_count;
        LightPattern pattern;
        auto operator<=>(const Key&) const = default;
    };
    struct Entry {
        std::uint64_t sample = 0;
        std::shared_ptr<const std::vector<LightSample>> positions;
    };
    Engine& engine_;
    bool many_samples_;
    const Frame* frame_ = nullptr;
    std::uint64_t sample_ = 0;
    std::map<Key, Entry> entries_;
};

}  // namespace shadow_layers
