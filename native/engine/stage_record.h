// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/clock.h"
#include "gl/timer_query.h"
#include "shadow_layers/request.h"

namespace shadow_layers {

/// Collects the times and counts of one layer (or of the frame) while its stages run. GL times are read at the end, so
/// that measuring waits for nothing.
class StageRecord {
public:
    struct Mark {
        std::size_t stage = 0;
        WallClock clock;
        gl::TimerQuery begin;
    };
    Mark begin(const gl::Device& device, const std::string& stage);
    void end(Mark mark);
    void count(const std::string& counter, std::int64_t amount) { counters_[counter] += amount; }
    void add_total_ms(double ms) { total_ms_ += ms; }

    /// Reads the finished timers into the sums. Blocks until the GL has worked all that was measured.
    void collect();
    RenderStats stats();  ///< collects first

private:
    struct Pending {
        std::size_t stage;
        gl::TimerQuery begin, end;
    };
    std::size_t stage_index(const std::string& stage);
    std::vector<StageTime> times_;
    std::vector<Pending> pending_;
    std::map<std::string, std::int64_t> counters_;
    double total_ms_ = 0;
};

}  // namespace shadow_layers
