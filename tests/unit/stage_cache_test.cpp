// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/stage_cache.h"

#include <gtest/gtest.h>

namespace shadow_layers {
namespace {

struct Value {
    std::size_t bytes;
    std::size_t byte_size() const { return bytes; }
};

/// True if the value had to be made.
bool ask(StageCache& cache, std::uint64_t key, std::size_t bytes) {
    bool made = false;
    cache.get<Value>({key, 0}, [&] {
        made = true;
        return std::make_shared<const Value>(Value{bytes});
    });
    return made;
}

TEST(StageCache, KeepsWhatWasMade) {
    StageCache cache(100);
    EXPECT_TRUE(ask(cache, 1, 40));
    EXPECT_FALSE(ask(cache, 1, 40));
    EXPECT_EQ(cache.bytes(), 40u);
}

TEST(StageCache, DropsTheLeastRecentlyUsedOverBudget) {
    StageCache cache(100);
    ask(cache, 1, 40);
    ask(cache, 2, 40);
    ask(cache, 1, 40);
    ask(cache, 3, 40);
    EXPECT_EQ(cache.bytes(), 80u);
    EXPECT_FALSE(ask(cache, 1, 40));
    EXPECT_TRUE(ask(cache, 2, 40));
}

TEST(StageCache, DoesNotKeepAValueOverTheWholeBudget) {
    StageCache cache(100);
    ask(cache, 1, 40);
    EXPECT_TRUE(ask(cache, 2, 101));
    EXPECT_TRUE(ask(cache, 2, 101));
    EXPECT_FALSE(ask(cache, 1, 40));
}

TEST(StageCache, ForgetsWhatTheLastRendersDidNotAskFor) {
    StageCache cache(1 << 20);
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

}  // namespace
}  // namespace shadow_layers
