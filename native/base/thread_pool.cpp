// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/thread_pool.h"

#include <algorithm>
#include <system_error>

namespace shadow_layers {

namespace {

constexpr int kMostThreads = 1024;  // as shadowcore's --threads

}  // namespace

struct ThreadPool::Loop {
    Loop(std::size_t item_count, std::size_t block_size, const std::function<void(std::size_t, std::size_t)>& loop_body)
        : count(item_count), block(block_size), body(loop_body) {}
    std::size_t count, block;
    const std::function<void(std::size_t, std::size_t)>& body;
    std::atomic<std::size_t> next{0};
    std::mutex error_mutex;
    std::exception_ptr error;
};

int core_count() { return std::max(1, int(std::thread::hardware_concurrency())); }

ThreadPool::ThreadPool(int thread_count) {
    const int wanted = thread_count > 0 ? thread_count : core_count();
    for (int i = 1; i < std::min(wanted, kMostThreads); ++i) {
        try {
            workers_.emplace_back([this] { work(); });
        } catch (const std::system_error&) {
            return;  // the system gives no more: those that are there do the work
        }
    }
}

ThreadPool::~ThreadPool() {
    {
        std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_all();
    for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::run_blocks(Loop& loop) {
    for (;;) {
        const std::size_t begin = loop.next.fetch_add(loop.block);
        if (begin >= loop.count) return;
        try {
            loop.body(begin, std::min(begin + loop.block, loop.count));
        } catch (...) {
            std::lock_guard lock(loop.error_mutex);
            if (!loop.error) loop.error = std::current_exception();
            loop.next.store(loop.count);
        }
    }
}

void ThreadPool::work() {
    std::size_t seen = 0;
    for (;;) {
        Loop* loop = nullptr;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [&] { return stopping_ || (loop_ && generation_ != seen); });
            if (stopping_) return;
            seen = generation_;
            loop = loop_;
            ++busy_;
        }
        run_blocks(*loop);
        {
            std::lock_guard lock(mutex_);
            --busy_;
        }
        done_.notify_all();
    }
}

void ThreadPool::parallel_for(std::size_t count, std::size_t block,
                              const std::function<void(std::size_t, std::size_t)>& body) {
    if (count == 0) return;
    Loop loop(count, std::max<std::size_t>(1, block), body);
    if (workers_.empty() || count <= loop.block) {
        run_blocks(loop);
    } else {
        {
            std::lock_guard lock(mutex_);
            loop_ = &loop;
            ++generation_;
        }
        wake_.notify_all();
        run_blocks(loop);
        std::unique_lock lock(mutex_);
        loop_ = nullptr;
        done_.wait(lock, [&] { return busy_ == 0; });
    }
    if (loop.error) std::rethrow_exception(loop.error);
}

}  // namespace shadow_layers
