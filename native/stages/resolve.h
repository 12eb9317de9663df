// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "engine/engine.h"
#include "engine/picture_target.h"
#include "frame/frame.h"
#include "light_params.h"
#include "lights/light_views.h"

namespace shadow_layers {

/// The sample's views, for as many of which the shaders have room. Error if there are more.
std::span<const LightView> get_shader_views(const LightSample& sample);

/// One light sample in the form of shaders/shared/light_params.h: matrices are composed in double with the frame's
/// origin, so that a scene far from the world's origin costs no precision.
LightParams make_light_params(const Frame& frame, const Light& light, const LightSample& sample);

/// Draws a full-screen program over the frame. Its fragment shader includes "stages/resolve_inputs.glsl". One pass
/// serves all views of a sample: the shader picks layer and matrix by cube face. Kept by a technique between frames.
class ResolvePass {
public:
    struct Task {
        const Frame& frame;
        const Light& light;
        const LightSample& sample;
        const gl::Program& program;  ///< may `discard` the pixels that it leaves to `second_program`
        /// Drawn over the pixels that `program` discarded, if any are to be expected. A depth test holds the others
        /// back: unlike a branch in the shader, that saves their cost on a software rasteriser too.
        const gl::Program* second_program = nullptr;
        GLenum format = GL_R32F;
        double work_per_pixel = 1;         ///< texture reads; long passes are cut into bands, so that a cancel is heard
        double second_work_per_pixel = 1;  ///< likewise, of the second program over its pixels
        /// Binds maps (units kDepthMapUnit and up) and sets the program's uniforms.
        std::function<void()> bind_inputs = {};
        std::function<void()> bind_second_inputs = {};  ///< sets the second program's uniforms
    };
    /// The result stays valid until the next run of this pass.
    const gl::Texture& run(Engine& engine, const Task& task);

private:
    PictureTarget target_;
    gl::Buffer params_buf_;
};

}  // namespace shadow_layers
