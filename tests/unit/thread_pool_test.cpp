// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/thread_pool.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

namespace shadow_layers {
namespace {

TEST(ThreadPool, RunsEveryItemOnce) {
    for (int threads : {1, 2, 5}) {
        ThreadPool pool(threads);
        EXPECT_EQ(pool.thread_count(), threads);
        for (std::size_t count : {0u, 1u, 7u, 1000u}) {
            std::vector<int> hits(count, 0);
            pool.parallel_for(count, 3, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) ++hits[i];
            });
            EXPECT_EQ(std::accumulate(hits.begin(), hits.end(), 0), int(count));
            for (int hit : hits) EXPECT_EQ(hit, 1);
        }
    }
}

TEST(ThreadPool, CutsTheSameBlocksOnAnyNumberOfThreads) {
    const auto cut = [](int threads) {
        ThreadPool pool(threads);
        std::vector<std::size_t> ends(10, 0);
        pool.parallel_for(95, 10, [&](std::size_t begin, std::size_t end) { ends[begin / 10] = end; });
        return ends;
    };
    EXPECT_EQ(cut(1), cut(4));
    EXPECT_EQ(cut(4).back(), 95u);
}

TEST(ThreadPool, RethrowsAndCanBeUsedAgain) {
    ThreadPool pool(3);
    const auto fail = [](std::size_t begin, std::size_t) {
        if (begin == 40) throw std::runtime_error("block 40");
    };
    EXPECT_THROW(pool.parallel_for(100, 10, fail), std::runtime_error);
    std::atomic<int> count{0};
    pool.parallel_for(100, 1, [&](std::size_t, std::size_t) { ++count; });
    EXPECT_EQ(count, 100);
}

TEST(ThreadPool, ManyShortLoops) {
    ThreadPool pool(4);
    std::atomic<std::size_t> sum{0};
    for (int i = 0; i < 2000; ++i) pool.parallel_for(8, 1, [&](std::size_t begin, std::size_t) { sum += begin; });
    EXPECT_EQ(sum, 2000u * 28u);
}

TEST(ThreadPool, ZeroMeansAllCores) { EXPECT_EQ(ThreadPool(0).thread_count(), core_count()); }

}  // namespace
}  // namespace shadow_layers
