// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>

namespace shadow_layers::truth {

/// How far layers are from the truth at the border: the mean distance over the pixels whose truth is neither 0 nor 1.
/// Of antialiased layers, the error of the coverage; other pixels are easy, and would hide it.
class BorderError {
public:
    /// Visibilities of a pixel, 0 to 1. A layer's value that is not a number is off by 1.
    void add(double layer, double truth) {
        if (!(truth > 0 && truth < 1)) return;
        ++pixels_;
        sum_ += std::isfinite(layer) ? std::abs(layer - truth) : 1;
    }
    std::size_t pixels() const { return pixels_; }
    /// 0 if there is no such pixel.
    double compute_mean() const { return pixels_ > 0 ? sum_ / double(pixels_) : 0; }

private:
    std::size_t pixels_ = 0;
    double sum_ = 0;
};

}  // namespace shadow_layers::truth
