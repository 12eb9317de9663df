// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "engine/engine.h"
#include "lights/light_views.h"
#include "session/light_render.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// The samples of lights in the current picture sample, with their views, made one at a time when asked for. A light's
/// only sample is shared by the techniques that want the same views; of many each is forgotten when its user lets go.
/// For renders of many picture samples those of the picture sample before are kept, so that still lights keep their
/// views and so their maps.
class LightCache {
public:
    LightCache(Engine& engine, bool many_picture_samples) : engine_(engine), keeps_(many_picture_samples) {}

    void begin_sample(const Frame& frame);
    /// Valid until the light is forgotten, cleared, or, of a render with one picture sample, until another is asked
    /// for.
    LightSamples get(std::uint32_t light, const TechniqueNeeds& needs);
    /// No later job of this picture sample or a later one wants this light.
    void forget(std::uint32_t light);
    void clear() { entries_.clear(); }

private:
    struct Key {
        std::uint32_t light;
        int map_size, border_texels, count;
        LightPattern pattern;
        auto operator<=>(const Key&) const = default;
    };
    struct Held {
        std::uint64_t picture_sample = 0;
        std::shared_ptr<const LightSample> sample;
    };
    struct Entry {
        std::vector<LightSample> points;  ///< without views
        std::vector<Held> held;           ///< of the same length
    };
    std::shared_ptr<const LightSample> get_sample(const Key& key, Entry& entry, std::size_t index);

    Engine& engine_;
    bool keeps_;
    const Frame* frame_ = nullptr;
    std::uint64_t picture_sample_ = 0;
    std::map<Key, Entry> entries_;
};

}  // namespace shadow_layers
