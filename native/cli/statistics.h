// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace shadow_layers::cli {

/// The value below which the fraction `q` of the samples lies, linear between them; 0 without samples.
inline double compute_quantile(std::vector<double> samples, double q) {
    if (samples.empty()) return 0.0;
    std::sort(samples.begin(), samples.end());
    const double place = q * double(samples.size() - 1);
    const auto below = std::size_t(place);
    const std::size_t above = std::min(below + 1, samples.size() - 1);
    return samples[below] + (place - double(below)) * (samples[above] - samples[below]);
}

inline double compute_median(const std::vector<double>& samples) { return compute_quantile(samples, 0.5); }

}  // namespace shadow_layers::cli
