// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <typeindex>
#include <unordered_map>

#include "shadow_layers/scene.h"

namespace shadow_layers {

/// Renders that a cached value outlives its last use. An animation that changes its meshes each frame then holds a few
/// frames' worth, and not all that its budget allows; views that are rendered in turn still find what they share.
inline constexpr std::uint64_t kKeptRenders = 4;

/// Values returned by stages, by the content of their inputs. Least recently used go first when over budget, and
/// without need for room once they are older than kKeptRenders. A stage's key hashes its name, its parameters and its
/// inputs' keys (see base/hash.h: KeyBuilder).
class StageCache {
public:
    explicit StageCache(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

    /// The cached value, or `make()`'s. T must have `std::size_t byte_size() const`.
    template <class T>
    std::shared_ptr<const T> get(const ContentKey& key, const std::function<std::shared_ptr<const T>()>& make) {
        if (auto hit = find(key, typeid(T))) return std::static_pointer_cast<const T>(hit);
        std::shared_ptr<const T> value = make();
        insert(key, typeid(T), value, value->byte_size());
        return value;
    }

    /// Marks the start of a render; lets go of what the last ones did not ask for.
    void begin_render();
    void clear();
    std::size_t bytes() const { return bytes_; }

private:
    std::shared_ptr<const void> find(const ContentKey& key, std::type_index type);
    void insert(const ContentKey& key, std::type_index type, std::shared_ptr<const void> value, std::size_t bytes);

    struct Entry {
        ContentKey key;
        std::type_index type;
        std::shared_ptr<const void> value;
        std::size_t bytes;
        std::uint64_t last_render;
    };
    void drop_last();

    struct KeyHash {
        std::size_t operator()(const ContentKey& key) const { return std::size_t(key.low); }
    };
    std::list<Entry> entries_;  ///< most recently used first
    std::unordered_map<ContentKey, std::list<Entry>::iterator, KeyHash> index_;
    std::size_t budget_bytes_, bytes_ = 0;
    std::uint64_t render_ = 0;
};

}  // namespace shadow_layers
