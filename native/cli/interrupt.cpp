// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/interrupt.h"

#include <unistd.h>

#include <ctime>
#include <utility>

namespace shadow_layers::cli {
namespace {

constexpr int kInterrupted = 130;  // as shells have it: 128 + SIGINT
constexpr long kPollNanoseconds = 50'000'000;

}  // namespace

HeldSignals::HeldSignals() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

HeldSignals::~HeldSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

Interrupt::Interrupt(const HeldSignals& signals, std::function<void()> stop)
    : signals_(signals), stop_(std::move(stop)), watcher_([this](const std::stop_token& token) { watch(token); }) {}

void Interrupt::watch(const std::stop_token& token) {
    bool asked = false;
    while (!token.stop_requested()) {
        const timespec timeout{0, kPollNanoseconds};
        if (sigtimedwait(&signals_.set(), nullptr, &timeout) < 0) {
            if (asked) stop_();  // again: the first may have come before the render had begun
            continue;
        }
        if (asked) _exit(kInterrupted);
        asked = true;
        stop_();
    }
}

}  // namespace shadow_layers::cli
