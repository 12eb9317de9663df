// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/content_cache.h"

#include <algorithm>

namespace shadow_layers {

void ContentCache::begin_render() {
    ++render_;
    while (!entries_.empty() && entries_.back().last_render + kKeptRenders < render_) drop(std::prev(entries_.end()));
}

void ContentCache::drop(Entries::iterator entry) {
    bytes_ -= entry->bytes;
    index_.erase(entry->id);
    if (entry->group) {
        const auto [begin, end] = groups_.equal_range(*entry->group);
        groups_.erase(std::find_if(begin, end, [&](const auto& item) { return item.second == entry; }));
    }
    entries_.erase(entry);
}

void ContentCache::clear() {
    groups_.clear();
    index_.clear();
    entries_.clear();
    bytes_ = 0;
}

std::shared_ptr<const void> ContentCache::find_value(const Id& id) {
    const auto found = index_.find(id);
    if (found == index_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    found->second->last_render = render_;
    return found->second->value;
}

void ContentCache::insert_entry(Entry entry) {
    if (const auto found = index_.find(entry.id); found != index_.end()) drop(found->second);
    if (entry.bytes > budget_bytes_) return;
    while (bytes_ + entry.bytes > budget_bytes_) drop(std::prev(entries_.end()));
    bytes_ += entry.bytes;
    entries_.push_front(std::move(entry));
    const auto first = entries_.begin();
    index_.emplace(first->id, first);
    if (first->group) groups_.emplace(*first->group, first);
}

}  // namespace shadow_layers
