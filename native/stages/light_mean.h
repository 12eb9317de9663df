// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/engine.h"
#include "engine/picture_target.h"
#include "frame/frame.h"
#include "lights/light_views.h"

namespace shadow_layers {

/// The mean of the visibilities that a light's samples have, each weighed by the light that the sample brings to the
/// receiver (find_light_weight in shaders/shared/light_weight.h). Kept between frames.
class LightMean {
public:
    /// Starts the sums of a light. Counts "picture_bytes".
    void begin(Engine& engine, const Frame& frame);
    /// `visibility`: R32F of the frame's size.
    void add(Engine& engine, const Frame& frame, const Light& light, const LightSample& sample,
             const gl::Texture& visibility);
    /// R32F of the frame's size; valid until the next call. Lit by all samples is 1 to the bit.
    const gl::Texture& finish(Engine& engine, const Frame& frame);

private:
    PictureTarget sums_, mean_;
    gl::Buffer params_buf_;
};

}  // namespace shadow_layers
