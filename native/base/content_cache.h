// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <typeindex>
#include <utility>

#include "shadow_layers/scene.h"

namespace shadow_layers {

/// Renders that a cached value outlives its last use. An animation that changes its meshes each frame then holds a few
/// frames' worth, and not all that its budget allows; views that are rendered in turn still find what they share.
inline constexpr std::uint64_t kKeptRenders = 4;

/// Values by their type and the content of what they are made from. Least recently used go first when over budget, and
/// without need for room once they are older than kKeptRenders. A value's key hashes the name of what makes it, its
/// parameters and its inputs' keys (base/hash.h: KeyBuilder). Not for several threads at once.
class ContentCache {
public:
    explicit ContentCache(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

    /// The cached value, or `make()`'s, a std::shared_ptr<const T>; T has `std::size_t byte_size() const`.
    template <class T, class Make>
    std::shared_ptr<const T> get(const ContentKey& key, const Make& make) {
        if (auto found = find<T>(key)) return found;
        std::shared_ptr<const T> value = make();
        insert<T>(key, value);
        return value;
    }
    /// The cached value, which is used by that; null if there is none.
    template <class T>
    std::shared_ptr<const T> find(const ContentKey& key) {
        return std::static_pointer_cast<const T>(find_value({typeid(T), key}));
    }
    /// Of the cached values that were inserted with this group the last one for which `holds(const T&)`, which is used
    /// by that, and its key; null if there is none.
    template <class T, class Holds>
    std::pair<std::shared_ptr<const T>, ContentKey> find_in_group(const ContentKey& group, const Holds& holds) {
        const auto [begin, end] = groups_.equal_range({typeid(T), group});
        for (auto item = end; item != begin;) {
            const Entry& entry = *(--item)->second;
            if (holds(*static_cast<const T*>(entry.value.get()))) return {find<T>(entry.id.second), entry.id.second};
        }
        return {};
    }
    /// Replaces one of this key. A value over the whole budget is used by its maker and not kept.
    template <class T>
    void insert(const ContentKey& key, std::shared_ptr<const T> value,
                const std::optional<ContentKey>& group = std::nullopt) {
        const std::size_t bytes = value->byte_size();
        Entry entry{{typeid(T), key}, std::nullopt, std::move(value), bytes, render_};
        if (group) entry.group.emplace(typeid(T), *group);
        insert_entry(std::move(entry));
    }

    /// Marks the start of a render; lets go of what the last ones did not ask for.
    void begin_render();
    void clear();
    std::size_t bytes() const { return bytes_; }

private:
    using Id = std::pair<std::type_index, ContentKey>;
    struct Entry {
        Id id;
        std::optional<Id> group;
        std::shared_ptr<const void> value;
        std::size_t bytes;
        std::uint64_t last_render;
    };
    using Entries = std::list<Entry>;
    std::shared_ptr<const void> find_value(const Id& id);
    void insert_entry(Entry entry);
    void drop(Entries::iterator entry);

    Entries entries_;  ///< most recently used first
    std::map<Id, Entries::iterator> index_;
    std::multimap<Id, Entries::iterator> groups_;
    std::size_t budget_bytes_, bytes_ = 0;
    std::uint64_t render_ = 0;
};

}  // namespace shadow_layers
