// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <functional>

#include "cli/bench_rows.h"
#include "shadow_layers/session.h"
#include "truth/border_error.h"

namespace shadow_layers::cli {

/// Whether this program was built with what errors are measured with.
bool can_measure_errors();

/// What is measured: layers against what they stand for; the bits of soft layers.
struct ErrorKinds {
    bool pictures = false, bits = false;
};

/// Fills in the rows' errors: each row is rendered once, unmoved, with one sample a pixel, and compared with exact
/// rays. Truths are worked once for all rows that share them. `tell` gets the fraction done. Throws Cancelled.
void measure_errors(Session& session, std::vector<BenchRow>& rows, const ErrorKinds& kinds, int threads,
                    const std::atomic<bool>& cancelled, const std::function<void(double)>& tell);

/// Errors of several layers together, each with its truth and a mark of the pixels that count.
class ErrorSum {
public:
    void add(const std::vector<float>& layer, const std::vector<float>& truth,
             const std::vector<std::uint8_t>& comparable);
    LayerErrors compute() const;

private:
    std::size_t pixels_ = 0, wrong_ = 0;
    double absolute_ = 0, squared_ = 0, signed_ = 0;
    truth::BorderError border_;
};

}  // namespace shadow_layers::cli
