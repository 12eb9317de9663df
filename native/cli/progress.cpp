// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress.h"

#include <unistd.h>

#include <cstdio>

namespace shadow_layers::cli {
namespace {

constexpr std::chrono::seconds kQuiet{2};
constexpr std::chrono::milliseconds kTerminalInterval{100}, kFileInterval{2000};

}  // namespace

Progress::Progress() : started_(Clock::now()), last_(started_ - kQuiet), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { clear(); }

void Progress::update(double fraction, const std::string& text) {
    const Clock::time_point now = Clock::now();
    if (now - started_ < kQuiet || now - last_ < (terminal_ ? kTerminalInterval : kFileInterval)) return;
    last_ = now;
    shown_ = true;
    std::fprintf(stderr, terminal_ ? "\r\x1b[K%3.0f %%  %s" : "%3.0f %%  %s\n", 100.0 * fraction, text.c_str());
    std::fflush(stderr);
}

void Progress::clear() {
    if (shown_ && terminal_) std::fputs("\r\x1b[K", stderr);
    shown_ = false;
}

}  // namespace shadow_layers::cli
