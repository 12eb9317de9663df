// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "shadow_layers/scene.h"

namespace shadow_layers {

/// XXH3-128 of the bytes.
ContentKey hash_bytes(const void* data, std::size_t byte_count);

/// XXH3-128 of the items' bytes. T must have no padding.
template <class T>
ContentKey hash_span(std::span<const T> items) {
    static_assert(std::is_trivially_copyable_v<T>);
    return hash_bytes(items.data(), items.size_bytes());
}

/// Collects the inputs of a value and makes its key. Every item is written with its kind and length, so that two
/// different sequences never give the same bytes ("ab","c" against "a","bc"; 1 against 1.0). Numbers count by their
/// bits: -0.0 and 0.0 differ.
///
///     ContentKey key = KeyBuilder("depth_map").add(view.key).add(size_texels).key();
class KeyBuilder {
public:
    explicit KeyBuilder(std::string_view name) { add(name); }

    template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) KeyBuilder& add(T value) {
        return add_item(kind_of<T>(), &value, sizeof value);
    }
    template <glm::length_t n, class T, glm::qualifier q>
    KeyBuilder& add(const glm::vec<n, T, q>& value) {
        return add_item(kind_of<T>(), &value[0], sizeof(T) * n);
    }
    template <glm::length_t c, glm::length_t r, class T, glm::qualifier q>
    KeyBuilder& add(const glm::mat<c, r, T, q>& value) {
        static_assert(sizeof value == sizeof(T) * c * r);
        return add_item(kind_of<T>(), &value[0][0], sizeof value);
    }
    KeyBuilder& add(std::string_view text) { return add_item('s', text.data(), text.size()); }
    KeyBuilder& add(const char* text) { return add(std::string_view(text)); }
    KeyBuilder& add(const ContentKey& key) { return add_item('k', &key, sizeof key); }
    /// Long spans are hashed first, so that the builder stays small.
    template <class T>
    KeyBuilder& add_span(std::span<const T> items) {
        return add(items.size()).add(hash_span(items));
    }

    ContentKey key() const { return hash_bytes(bytes_.data(), bytes_.size()); }

private:
    template <class T>
    static constexpr char kind_of() {
        if constexpr (std::is_floating_point_v<T>)
            return 'f';
        else if constexpr (std::is_enum_v<T>)
            return 'e';
        else if constexpr (std::is_same_v<T, bool>)
            return 'b';
        else
            return std::is_signed_v<T> ? 'i' : 'u';
    }
    KeyBuilder& add_item(char kind, const void* data, std::size_t byte_count);

    std::vector<unsigned char> bytes_;
};

}  // namespace shadow_layers
