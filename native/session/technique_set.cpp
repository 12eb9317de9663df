// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/technique_set.h"

#include "base/content_cache.h"

namespace shadow_layers {

TechniqueSet::TechniqueSet(std::vector<TechniqueEntry> entries) : entries_(std::move(entries)) {
    for (const TechniqueEntry& entry : entries_) descriptors_.push_back(make_descriptor(entry));
}

Technique& TechniqueSet::get(const std::string& id) {
    Made& made = made_[id];
    made.last_render = render_;
    for (std::size_t i = 0; i < entries_.size() && !made.technique; ++i)
        if (descriptors_[i].id == id) made.technique = entries_[i].make();
    return *made.technique;
}

void TechniqueSet::begin_render() {
    ++render_;
    std::erase_if(made_, [&](const auto& entry) { return entry.second.last_render + kKeptRenders < render_; });
}

}  // namespace shadow_layers
