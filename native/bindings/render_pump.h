// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "shadow_layers/session.h"

namespace shadow_layers::bindings {

/// What Python wants to hear of a render. Called with the GIL held; what they throw ends the render.
struct RenderListener {
    std::function<void(Layer&&)> on_layer;
    std::function<void(double, const std::string&)> on_progress;  ///< may be empty
    std::function<void()> poll;  ///< every kPollInterval at most: Ctrl-C, deferred work
};

/// One render, pumped: Session::render blocks a helper thread that never touches Python, while the Python thread that
/// called waits for its messages without the GIL, wakes up often enough for Ctrl-C, and hands them to the listener.
/// So no thread that a holder of the GIL waits for ever wants the GIL itself.
class RenderPump {
public:
    explicit RenderPump(Session& session) : session_(session) {}

    /// Call with the GIL held; throws what the listener threw, else what the session threw.
    FrameResult run(const RenderRequest& request, const RenderListener& listener);

private:
    struct Messages {
        std::optional<Layer> layer;
        std::optional<std::pair<double, std::string>> progress;
        bool done = false;
    };
    void post_layer(Layer&& layer);
    Messages wait();
    void abandon();

    Session& session_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Layer> layer_;  ///< one at a time: a slow listener holds the render back, not memory
    std::optional<std::pair<double, std::string>> progress_;
    bool done_ = false;
    bool abandoned_ = false;  ///< the listener threw: nothing is handed over any more
};

}  // namespace shadow_layers::bindings
