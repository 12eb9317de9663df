// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

namespace shadow_layers::cli {

/// A line on standard error for what takes more than two seconds: redrawn on a terminal, else a new one now and then.
class Progress {
public:
    Progress();
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Where the work stands: fraction in [0, 1], and what is done now.
    void update(double fraction, const std::string& text);

    /// Ends the line, before other text is printed.
    void clear();

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point started_, last_;
    bool terminal_ = false, shown_ = false;
};

}  // namespace shadow_layers::cli
