// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>

namespace shadow_layers {

static_assert(sizeof(ContentKey) == 16);

ContentKey hash_bytes(const void* data, std::size_t byte_count) {
    const XXH128_hash_t hash = XXH3_128bits(data, byte_count);
    return {hash.low64, hash.high64};
}

KeyBuilder& KeyBuilder::add_item(char kind, const void* data, std::size_t byte_count) {
    const std::uint64_t length = byte_count;
    const std::size_t start = bytes_.size();
    bytes_.resize(start + 1 + sizeof length + byte_count);
    bytes_[start] = static_cast<unsigned char>(kind);
    std::memcpy(&bytes_[start + 1], &length, sizeof length);
    if (byte_count > 0) std::memcpy(&bytes_[start + 1 + sizeof length], data, byte_count);
    return *this;
}

}  // namespace shadow_layers
