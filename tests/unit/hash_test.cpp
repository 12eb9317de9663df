// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#include <gtest/gtest.h>

#include <array>

namespace shadow_layers {
namespace {

TEST(Hash, EmptyInputGivesTheKeyOfTheSpecification) {
    // XXH3-128 of no bytes with seed 0, as xxHash's own `xxh128sum /dev/null` prints it.
    const ContentKey key = hash_bytes(nullptr, 0);
    EXPECT_EQ(key.high, 0x99aa06d3014798d8u);
    EXPECT_EQ(key.low, 0x6001c324468d497fu);
}

TEST(Hash, EveryBitCounts) {
    std::array<unsigned char, 300> bytes{};
    const ContentKey plain = hash_bytes(bytes.data(), bytes.size());
    for (std::size_t i = 0; i < bytes.size() * 8; ++i) {
        bytes[i / 8] ^= static_cast<unsigned char>(1u << i % 8);
        EXPECT_NE(hash_bytes(bytes.data(), bytes.size()), plain) << "bit " << i;
        bytes[i / 8] ^= static_cast<unsigned char>(1u << i % 8);
    }
}

TEST(KeyBuilder, SplitsAndKindsGiveDifferentKeys) {
    const auto key = [](auto... values) { return (KeyBuilder("t").add(values), ...).key(); };
    EXPECT_NE(KeyBuilder("t").add("ab").add("c").key(), KeyBuilder("t").add("a").add("bc").key());
    EXPECT_NE(KeyBuilder("t").add("").key(), KeyBuilder("t").key());
    EXPECT_NE(key(std::int64_t{1}), key(1.0));
    EXPECT_NE(key(1.0), key(1.0f));
    EXPECT_NE(key(true), key(std::uint8_t{1}));
    EXPECT_NE(key(0.0), key(-0.0));
    EXPECT_NE(KeyBuilder("depth_map").add(1).key(), KeyBuilder("moment_map").add(1).key());
    EXPECT_EQ(key(glm::dmat4(2.0)), key(glm::dmat4(2.0)));
    EXPECT_NE(key(glm::dmat4(2.0)), key(glm::dmat4(3.0)));
}

TEST(KeyBuilder, SpansCountByLengthAndContent) {
    const std::array<int, 4> numbers{1, 2, 3, 4};
    const std::span<const int> all(numbers);
    EXPECT_NE(KeyBuilder("s").add_span(all).key(), KeyBuilder("s").add_span(all.first(3)).key());
    EXPECT_EQ(KeyBuilder("s").add_span(all).key(), KeyBuilder("s").add_span(all).key());
    EXPECT_NE(KeyBuilder("s").add_span(all.first(0)).key(), KeyBuilder("s").key());
}

}  // namespace
}  // namespace shadow_layers
