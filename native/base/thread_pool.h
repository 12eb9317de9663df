// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace shadow_layers {

/// A fixed set of threads for loops. The calling thread works too, so that a pool of 1 makes no thread at all.
/// Used by one thread at a time (the session's worker).
class ThreadPool {
public:
    /// `thread_count` <= 0: one per core. Fewer are made where the system gives no more; at most 1024.
    explicit ThreadPool(int thread_count);
    ~ThreadPool();
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    int thread_count() const { return int(workers_.size()) + 1; }

    /// Calls body(begin, end) over [0, count) in blocks of at most `block` items, in any order and on any thread, and
    /// returns when all are done. Blocks are cut the same way whatever the number of threads, so a body that writes
    /// per item or per block gives the same bytes on every run. The first exception is rethrown here.
    void parallel_for(std::size_t count, std::size_t block,
                      const std::function<void(std::size_t begin, std::size_t end)>& body);

private:
    struct Loop;
    void work();
    static void run_blocks(Loop& loop);

    std::vector<std::thread> workers_;
    std::mutex mutex_;
    std::condition_variable wake_, done_;
    Loop* loop_ = nullptr;
    std::size_t generation_ = 0;
    int busy_ = 0;
    bool stopping_ = false;
};

/// Number of logical cores, at least 1.
int core_count();

}  // namespace shadow_layers
