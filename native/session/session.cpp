// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "shadow_layers/session.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include "context/context.h"
#include "session/render_run.h"

namespace shadow_layers {
namespace {

// Layers that wait for the caller before the worker waits too: a slow sink must not pile up 500 pictures.
constexpr std::size_t kWaitingLayers = 4;

/// One call of Session::render, between the caller's thread and the worker.
struct RenderTicket {
    const RenderRequest& request;
    bool wants_progress;
    // Guarded by the session's mutex.
    std::deque<Layer> layers;
    std::optional<std::pair<double, std::string>> progress;
    bool cancelled = false, done = false;
    FrameResult result;
    std::exception_ptr error;
};

}  // namespace

struct Session::Impl {
    explicit Impl(SessionOptions session_options) : options(std::move(session_options)) {}

    void run_worker(std::promise<void>& ready);
    void work(Engine& engine, const std::shared_ptr<FramePool>& pool, TechniqueSet& techniques);
    FrameResult run_ticket(RenderTicket& ticket, Engine& engine, const std::shared_ptr<FramePool>& pool,
                           TechniqueSet& techniques);
    void pump(RenderTicket& ticket, const LayerSink& sink, const ProgressSink& progress);
    void cancel_ticket(RenderTicket& ticket);

    SessionOptions options;
    SessionInfo info;
    std::thread worker;
    std::mutex mutex;
    std::condition_variable changed;  ///< anything below, or in a ticket
    std::deque<RenderTicket*> queue;
    RenderTicket* running = nullptr;
    CancelToken* token = nullptr;
    bool closing = false;
    int callers = 0;
    std::mutex close_mutex;
    std::atomic<std::size_t> host_bytes{0}, gpu_bytes{0};
};

// --- the worker's side ---

void Session::Impl::run_worker(std::promise<void>& ready) {
    std::unique_ptr<Context> context;
    std::unique_ptr<Engine> engine;
    try {
        context = make_context(options.backend, options.threads);
        engine = std::make_unique<Engine>(*context,
                                          EngineOptions{options.shader_dir, options.threads, options.gpu_cache_bytes,
                                                        options.host_cache_bytes, options.debug});
        const gl::Device& device = engine->device();
        info = {context->description(),
                device.version(),
                device.renderer(),
                device.vendor(),
                engine->threads().thread_count(),
                device.limits().max_texture_size,
                context->software() || device.software()};
        token = &engine->cancel_token();
        ready.set_value();
    } catch (...) {
        engine.reset();
        context.reset();
        ready.set_exception(std::current_exception());
        return;
    }
    {
        const auto pool = std::make_shared<FramePool>();
        TechniqueSet techniques(technique_entries());
        work(*engine, pool, techniques);
        pool->clear();
    }
    engine.reset();
}

void Session::Impl::work(Engine& engine, const std::shared_ptr<FramePool>& pool, TechniqueSet& techniques) {
    for (;;) {
        RenderTicket* ticket = nullptr;
        {
            std::unique_lock lock(mutex);
            changed.wait(lock, [&] { return closing || !queue.empty(); });
            if (closing) return;
            ticket = queue.front();
            queue.pop_front();
            running = ticket;
            token->reset();
            if (ticket->cancelled) token->request();
        }
        FrameResult result;
        std::exception_ptr error;
        try {
            result = run_ticket(*ticket, engine, pool, techniques);
        } catch (const std::bad_alloc&) {
            error = std::make_exception_ptr(
                DriverError("memory ran out while rendering; render a smaller picture, fewer samples or smaller maps"));
        } catch (...) {
            error = std::current_exception();
        }
        host_bytes = pool->host_bytes() + engine.mesh_data().bytes();
        gpu_bytes = engine.gpu_bytes();
        {
            std::lock_guard lock(mutex);
            ticket->result = std::move(result);
            // A cancel that came after the last look at the token still counts: its layers were dropped.
            ticket->error = ticket->cancelled && !error ? std::make_exception_ptr(Cancelled()) : error;
            ticket->done = true;
            running = nullptr;
        }
        changed.notify_all();
    }
}

FrameResult Session::Impl::run_ticket(RenderTicket& ticket, Engine& engine, const std::shared_ptr<FramePool>& pool,
                                      TechniqueSet& techniques) {
    RenderOutlet outlet;
    outlet.deliver = [&](Layer&& layer) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return ticket.layers.size() < kWaitingLayers || ticket.cancelled || closing; });
        ticket.layers.push_back(std::move(layer));
        lock.unlock();
        changed.notify_all();
    };
    if (ticket.wants_progress)
        outlet.progress = [&](double fraction, const std::string& text) {
            {
                std::lock_guard lock(mutex);
                ticket.progress.emplace(fraction, text);
            }
            changed.notify_all();
        };
    return run_render(engine, pool, techniques, ticket.request, outlet);
}

// --- the callers' side ---

void Session::Impl::cancel_ticket(RenderTicket& ticket) {
    ticket.cancelled = true;
    if (running == &ticket) token->request();
}

/// Hands on layers and progress until the render is done. What a sink throws cancels the render and goes to the caller.
void Session::Impl::pump(RenderTicket& ticket, const LayerSink& sink, const ProgressSink& progress) {
    std::exception_ptr sink_error;
    std::unique_lock lock(mutex);
    for (;;) {
        changed.wait(lock, [&] { return ticket.done || !ticket.layers.empty() || ticket.progress; });
        if (ticket.done && (ticket.error || sink_error)) break;
        if (ticket.done && ticket.layers.empty()) break;
        std::deque<Layer> layers;
        std::swap(layers, ticket.layers);
        const auto news = std::exchange(ticket.progress, std::nullopt);
        const bool is_dropped = ticket.cancelled;
        lock.unlock();
        changed.notify_all();
        try {
            if (news && progress && !is_dropped) progress(news->first, news->second);
            for (Layer& layer : layers)
                if (sink && !is_dropped) sink(std::move(layer));
        } catch (...) {
            if (!sink_error) sink_error = std::current_exception();
        }
        lock.lock();
        if (sink_error) cancel_ticket(ticket);
    }
    lock.unlock();
    if (sink_error) std::rethrow_exception(sink_error);
    if (ticket.error) std::rethrow_exception(ticket.error);
}

Session::Session(SessionOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {
    std::promise<void> ready;
    auto is_ready = ready.get_future();
    impl_->worker = std::thread([&] { impl_->run_worker(ready); });
    try {
        is_ready.get();
    } catch (...) {
        impl_->worker.join();
        throw;
    }
}

Session::~Session() {
    close();
    // Callers on other threads leave with Cancelled; their tickets point into this.
    std::unique_lock lock(impl_->mutex);
    impl_->changed.wait(lock, [&] { return impl_->callers == 0; });
}

const SessionInfo& Session::info() const { return impl_->info; }

FrameResult Session::render(const RenderRequest& request, const LayerSink& sink, const ProgressSink& progress) {
    RenderTicket ticket{request, bool(progress), {}, {}, false, false, {}, {}};
    {
        std::lock_guard lock(impl_->mutex);
        if (impl_->closing) throw InputError("the session is closed; make a new one");
        impl_->queue.push_back(&ticket);
        ++impl_->callers;
    }
    impl_->changed.notify_all();
    struct Leave {
        Impl& impl;
        ~Leave() {
            {
                std::lock_guard lock(impl.mutex);
                --impl.callers;
                impl.changed.notify_all();
            }
        }
    } leave{*impl_};
    impl_->pump(ticket, sink, progress);
    return std::move(ticket.result);
}

void Session::cancel() {
    std::lock_guard lock(impl_->mutex);
    if (impl_->running)
        impl_->cancel_ticket(*impl_->running);
    else if (!impl_->queue.empty())
        impl_->cancel_ticket(*impl_->queue.front());
    impl_->changed.notify_all();
}

std::size_t Session::host_bytes() const { return impl_->host_bytes; }
std::size_t Session::gpu_bytes() const { return impl_->gpu_bytes; }

void Session::close() {
    {
        std::lock_guard lock(impl_->mutex);
        impl_->closing = true;
        if (impl_->running) impl_->cancel_ticket(*impl_->running);
        for (RenderTicket* ticket : impl_->queue) {
            ticket->error = std::make_exception_ptr(Cancelled());
            ticket->done = true;
        }
        impl_->queue.clear();
    }
    impl_->changed.notify_all();
    std::lock_guard join_lock(impl_->close_mutex);
    if (impl_->worker.joinable()) impl_->worker.join();
}

}  // namespace shadow_layers
