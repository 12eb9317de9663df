// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "stages/resolve.h"

namespace shadow_layers {

/// Wider kernels are worked as runs of bits in any case: a software rasteriser ends long loops.
inline constexpr int kMostSingleTaps = 16;

/// A square kernel of revectorised visibilities.
struct RevectorisedFilterSettings {
    int kernel = 3;              ///< taps per side
    int spacing_texels = 1;      ///< from tap to tap
    int walk_limit = 16;         ///< texels
    bool smooth = false;         ///< v_RSMSS, else v_SMSR
    bool cases_of_paper = true;  ///< smooth only: one-texel channels by the paper's cases, else as disjoint coverage
    bool early_out = true;       ///< false: each tap of each pixel on its own, as a reference; see kMostSingleTaps

    /// Texels from the receiver's own to the farthest that is tested before any walk.
    int window_radius() const;
    /// How far all tests reach, walks included: the border that maps need.
    int margin_texels() const { return window_radius() + walk_limit + 2; }
    bool operator==(const RevectorisedFilterSettings&) const = default;
};

/// A resolve in two programs: the first decides the pixels in whose kernel no test differs, the second evaluates the
/// others. Kept by a technique between frames.
class RevectorisedFilterPass {
public:
    void prepare(Engine& engine, const RevectorisedFilterSettings& settings);

    /// Visibility (R32F), valid until the next run. Makes the depth map and its range map.
    const gl::Texture& run(Engine& engine, const Frame& frame, const Light& light, const LightSample& sample);

private:
    RevectorisedFilterSettings settings_;
    const gl::Program* decider_ = nullptr;
    const gl::Program* evaluator_ = nullptr;
    ResolvePass resolve_;
};

}  // namespace shadow_layers
