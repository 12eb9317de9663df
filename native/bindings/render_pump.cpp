// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/render_pump.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>
#include <vector>

#include "bindings/bindings.h"

namespace shadow_layers::bindings {
namespace {

constexpr std::chrono::milliseconds kPollInterval{50};

/// The sessions whose callbacks run on this thread. A render of the same session from within one would wait for the
/// outer render, which waits for the callback.
thread_local std::vector<const Session*> sessions_here;

class RunsHere {
public:
    explicit RunsHere(const Session& session) {
        if (std::find(sessions_here.begin(), sessions_here.end(), &session) != sessions_here.end())
            throw InputError(
                "Session.render was called from on_layer or on_progress of the same session's render; "
                "call it when that render has returned, or use a second session");
        sessions_here.push_back(&session);
    }
    ~RunsHere() { sessions_here.pop_back(); }
    RunsHere(const RunsHere&) = delete;
    RunsHere& operator=(const RunsHere&) = delete;
};

}  // namespace

void RenderPump::post_layer(Layer&& layer) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !layer_ || abandoned_; });
    if (abandoned_) return;
    layer_ = std::move(layer);
    changed_.notify_all();
}

RenderPump::Messages RenderPump::wait() {
    const GilRelease release;
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPollInterval, [&] { return layer_ || progress_ || done_; });
    Messages messages;
    messages.layer = std::exchange(layer_, std::nullopt);
    messages.progress = std::exchange(progress_, std::nullopt);
    messages.done = done_;
    changed_.notify_all();
    return messages;
}

void RenderPump::abandon() {
    {
        std::lock_guard lock(mutex_);
        abandoned_ = true;
        layer_.reset();
        changed_.notify_all();
    }
    session_.cancel();
}

FrameResult RenderPump::run(const RenderRequest& request, const RenderListener& listener) {
    const RunsHere runs_here(session_);
    FrameResult result;
    std::exception_ptr core_failure, listener_failure;
    std::jthread helper([&] {
        try {
            ProgressSink progress;
            if (listener.on_progress) {
                progress = [&](double fraction, const std::string& text) {
                    std::lock_guard lock(mutex_);
                    progress_ = {fraction, text};
                    changed_.notify_all();
                };
            }
            result = session_.render(
                request, [&](Layer&& layer) { post_layer(std::move(layer)); }, progress);
        } catch (...) {
            core_failure = std::current_exception();
        }
        std::lock_guard lock(mutex_);
        done_ = true;
        changed_.notify_all();
    });
    for (bool done = false; !done;) {
        Messages messages = wait();
        // Only what was taken after the end was posted is surely the last.
        done = messages.done;
        try {
            if (!listener_failure && messages.layer) listener.on_layer(std::move(*messages.layer));
            if (!listener_failure && messages.progress)
                listener.on_progress(messages.progress->first, messages.progress->second);
            if (!listener_failure) listener.poll();
        } catch (abi::__forced_unwind&) {
            hang_until_exit();
        } catch (...) {
            listener_failure = std::current_exception();
        }
        if (listener_failure && !done) abandon();  // again each time: the first may come before the render has begun
    }
    if (listener_failure) std::rethrow_exception(listener_failure);
    if (core_failure) std::rethrow_exception(core_failure);
    return result;
}

}  // namespace shadow_layers::bindings
