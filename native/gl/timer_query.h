// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gl/device.h"

namespace shadow_layers::gl {

/// A point in time on the GL's own clock, taken when all commands before it are done. Two of them time a stage, and
/// stages may nest, which GL_TIME_ELAPSED forbids.
class TimerQuery : public Tracked {
public:
    TimerQuery() = default;
    explicit TimerQuery(const Device& device);
    TimerQuery(TimerQuery&&) noexcept = default;
    TimerQuery& operator=(TimerQuery&& other) noexcept;
    ~TimerQuery();

    void mark();
    double wait_ms() const;  ///< blocks until the mark was reached
};

}  // namespace shadow_layers::gl
