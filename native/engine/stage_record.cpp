// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/stage_record.h"

#include <algorithm>

namespace shadow_layers {

std::size_t StageRecord::stage_index(const std::string& stage) {
    const auto found =
        std::find_if(times_.begin(), times_.end(), [&](const auto& time) { return time.stage == stage; });
    if (found != times_.end()) return std::size_t(found - times_.begin());
    times_.push_back({stage, 0, -1});
    return times_.size() - 1;
}

StageRecord::Mark StageRecord::begin(const gl::Device& device, const std::string& stage) {
    Mark mark{stage_index(stage), {}, gl::TimerQuery(device)};
    mark.begin.mark();
    return mark;
}

void StageRecord::end(Mark mark) {
    times_[mark.stage].cpu_ms += mark.clock.elapsed_ms();
    gl::TimerQuery end(mark.begin.device());
    end.mark();
    // Without it a software driver takes the mark with whatever comes next, and CPU work in between counts as GL time.
    end.gl().Flush();
    pending_.push_back({mark.stage, std::move(mark.begin), std::move(end)});
}

void StageRecord::collect() {
    for (const Pending& pending : pending_) {
        double& gl_ms = times_[pending.stage].gl_ms;
        gl_ms = std::max(0.0, gl_ms) + std::max(0.0, pending.end.wait_ms() - pending.begin.wait_ms());
    }
    pending_.clear();
}

RenderStats StageRecord::stats() {
    collect();
    return {times_, counters_, total_ms_};
}

}  // namespace shadow_layers
