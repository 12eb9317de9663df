// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <csignal>
#include <functional>
#include <thread>

namespace shadow_layers::cli {

/// Holds Ctrl-C and SIGTERM back while it lives. Make it before other threads: they inherit its signal mask.
class HeldSignals {
public:
    HeldSignals();
    ~HeldSignals();
    HeldSignals(const HeldSignals&) = delete;
    HeldSignals& operator=(const HeldSignals&) = delete;

    const sigset_t& set() const { return signals_; }

private:
    sigset_t signals_, before_;
};

/// While it lives, a held signal calls `stop` from a thread of its own, so that the render ends and temporary files are
/// removed. A second one ends the process at once.
class Interrupt {
public:
    Interrupt(const HeldSignals& signals, std::function<void()> stop);

private:
    void watch(const std::stop_token& token);

    const HeldSignals& signals_;
    std::function<void()> stop_;
    std::jthread watcher_;  // last: it is ended first
};

}  // namespace shadow_layers::cli
