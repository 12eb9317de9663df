// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "stages/moment_map.h"
#include "stages/resolve.h"

namespace shadow_layers {

/// A resolve against a moment map. Kept by a technique between frames.
class MomentResolvePass {
public:
    /// Makes depth and moment map and draws `program`, whose fragment shader includes
    /// "stages/moment_inputs.glsl"; `set_uniforms` sets those of the technique's own. Visibility (R32F), valid until
    /// the next run.
    const gl::Texture& run(Engine& engine, const Frame& frame, const Light& light, const LightSample& position,
                           const MomentMapOptions& options, const gl::Program& program,
                           const std::function<void()>& set_uniforms);

private:
    ResolvePass resolve_;
};

}  // namespace shadow_layers
