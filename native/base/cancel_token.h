// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

#include "shadow_layers/error.h"

namespace shadow_layers {

/// Asked for by any thread, honoured by the thread that works.
class CancelToken {
public:
    void request() { requested_.store(true, std::memory_order_relaxed); }
    void reset() { requested_.store(false, std::memory_order_relaxed); }
    bool requested() const { return requested_.load(std::memory_order_relaxed); }

    /// Throws Cancelled once a cancel was requested.
    void check() const {
        if (requested()) throw Cancelled();
    }

private:
    std::atomic<bool> requested_{false};
};

}  // namespace shadow_layers
