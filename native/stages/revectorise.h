// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "stages/resolve.h"

namespace shadow_layers {

/// How a revectorised resolve compares and walks.
struct RevectoriseSettings {
    int walk_limit = 16;       ///< texels
    bool follow_slope = true;  ///< each texel is compared in the receiver's own plane; else all with one depth
    bool exiting = false;      ///< texels in shadow are revectorised too
    /// Defines of shaders/stages/revectorise_inputs.glsl, for the walking program.
    gl::Defines defines() const;
};

/// A resolve in two programs: the first decides the pixels whose texel has no discontinuity, the second walks for the
/// others. Kept by a technique between frames.
class RevectorisePass {
public:
    /// `walker`: fragment shader on stages/revectorise_inputs.glsl; `defines`: its own besides the settings'.
    void prepare(Engine& engine, const RevectoriseSettings& settings, const std::string& walker, gl::Defines defines);

    /// Visibility (R32F), valid until the next run. Makes the depth map.
    const gl::Texture& run(Engine& engine, const Frame& frame, const Light& light, const LightSample& sample);

private:
    RevectoriseSettings settings_;
    const gl::Program* decider_ = nullptr;
    const gl::Program* walker_ = nullptr;
    ResolvePass resolve_;
};

}  // namespace shadow_layers
