// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/stage_cache.h"

namespace shadow_layers {

void StageCache::begin_render() {
    ++render_;
    while (!entries_.empty() && entries_.back().last_render + kKeptRenders < render_) drop_last();
}

void StageCache::drop_last() {
    bytes_ -= entries_.back().bytes;
    index_.erase(entries_.back().key);
    entries_.pop_back();
}

void StageCache::clear() {
    index_.clear();
    entries_.clear();
    bytes_ = 0;
}

std::shared_ptr<const void> StageCache::find(const ContentKey& key, std::type_index type) {
    const auto found = index_.find(key);
    if (found == index_.end() || found->second->type != type) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    found->second->last_render = render_;
    return found->second->value;
}

void StageCache::insert(const ContentKey& key, std::type_index type, std::shared_ptr<const void> value,
                        std::size_t bytes) {
    if (const auto found = index_.find(key); found != index_.end()) {
        bytes_ -= found->second->bytes;
        entries_.erase(found->second);
        index_.erase(found);
    }
    // A value over the whole budget is used by its maker and not kept.
    if (bytes > budget_bytes_) return;
    while (bytes_ + bytes > budget_bytes_) drop_last();
    entries_.push_front({key, type, std::move(value), bytes, render_});
    index_[key] = entries_.begin();
    bytes_ += bytes;
}

}  // namespace shadow_layers
