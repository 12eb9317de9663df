// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/content_cache.h"

#include <gtest/gtest.h>

namespace shadow_layers {
namespace {

struct Value {
    std::size_t bytes;
    std::size_t byte_size() const { return bytes; }
};

/// True if the value had to be made.
bool ask(ContentCache& cache, std::uint64_t key, std::size_t bytes) {
    bool made = false;
    cache.get<Value>({key, 0}, [&] {
        made = true;
        return std::make_shared<const Value>(Value{bytes});
    });
    return made;
}

TEST(ContentCache, KeepsWhatWasMade) {
    ContentCache cache(100);
    EXPECT_TRUE(ask(cache, 1, 40));
    EXPECT_FALSE(ask(cache, 1, 40));
    EXPECT_EQ(cache.bytes(), 40u);
}

TEST(ContentCache, DropsTheLeastRecentlyUsedOverBudget) {
    ContentCache cache(100);
    ask(cache, 1, 40);
    ask(cache, 2, 40);
    ask(cache, 1, 40);
    ask(cache, 3, 40);
    EXPECT_EQ(cache.bytes(), 80u);
    EXPECT_FALSE(ask(cache, 1, 40));
    EXPECT_TRUE(ask(cache, 2, 40));
}

TEST(ContentCache, DoesNotKeepAValueOverTheWholeBudget) {
    ContentCache cache(100);
    ask(cache, 1, 40);
    EXPECT_TRUE(ask(cache, 2, 101));
    EXPECT_TRUE(ask(cache, 2, 101));
    EXPECT_FALSE(ask(cache, 1, 40));
}

TEST(ContentCache, ForgetsWhatTheLastRendersDidNotAskFor) {
    ContentCache cache(1 << 20);
    std::size_t at_tenth = 0;
    for (std::uint64_t render = 1; render <= 200; ++render) {
        cache.begin_render();
        EXPECT_EQ(ask(cache, 0, 7), render == 1) << render;  // the same in every render: stays
        EXPECT_TRUE(ask(cache, render, 10));                 // a new one in each: an animation
        if (render == 10) at_tenth = cache.bytes();
    }
    EXPECT_EQ(cache.bytes(), at_tenth);
    EXPECT_EQ(cache.bytes(), 7 + 10 * (kKeptRenders + 1));
}

TEST(ContentCache, TellsTypesApart) {
    struct Other : Value {};
    ContentCache cache(100);
    ask(cache, 1, 40);
    EXPECT_EQ(cache.find<Other>({1, 0}), nullptr);
    cache.insert<Other>({1, 0}, std::make_shared<const Other>(Other{7}));
    EXPECT_EQ(cache.find<Value>({1, 0})->bytes, 40u);
    EXPECT_EQ(cache.find<Other>({1, 0})->bytes, 7u);
}

TEST(ContentCache, FindsTheLastOfAGroup) {
    ContentCache cache(100);
    const ContentKey group{1, 1}, other{2, 2};
    const auto insert = [&](std::uint64_t key, std::size_t bytes, const ContentKey& of) {
        cache.insert<Value>({key, 0}, std::make_shared<const Value>(Value{bytes}), of);
    };
    const auto find = [&](std::size_t least, const ContentKey& of) {
        return cache.find_in_group<Value>(of, [&](const Value& value) { return value.bytes >= least; });
    };
    EXPECT_EQ(find(0, group).first, nullptr);
    insert(1, 30, group), insert(2, 20, group), insert(3, 25, other);
    EXPECT_EQ(find(0, group).first->bytes, 20u);
    EXPECT_EQ(find(0, group).second, (ContentKey{2, 0}));
    EXPECT_EQ(find(21, group).first->bytes, 30u);
    EXPECT_EQ(find(31, group).first, nullptr);
    EXPECT_EQ(find(0, other).first->bytes, 25u);
    insert(1, 10, group);  // anew
    EXPECT_EQ(find(0, group).first->bytes, 10u);
    EXPECT_EQ(cache.bytes(), 55u);
    find(20, group);
    insert(4, 75, other);  // makes room by what was not used for longest
    EXPECT_EQ(find(0, group).first->bytes, 20u);
    EXPECT_EQ(find(0, other).first->bytes, 75u);
    EXPECT_EQ(cache.bytes(), 95u);
    cache.clear();
    EXPECT_EQ(find(0, group).first, nullptr);
    EXPECT_EQ(cache.bytes(), 0u);
}

TEST(ContentCache, KeepsNothingOfAMakerThatThrows) {
    ContentCache cache(100);
    const auto fail = []() -> std::shared_ptr<const Value> { throw 1; };
    EXPECT_THROW(cache.get<Value>({1, 0}, fail), int);
    EXPECT_EQ(cache.bytes(), 0u);
    EXPECT_TRUE(ask(cache, 1, 40));
}

}  // namespace
}  // namespace shadow_layers
