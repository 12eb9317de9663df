// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gl/device.h"

namespace shadow_layers {

/// The fixed-function state of a draw, set as a whole so that no stage inherits another's. Nothing is culled by
/// winding.
struct DrawState {
    bool depth_test = false;
    bool depth_write = false;            ///< needs depth_test
    GLenum depth_function = GL_GREATER;  ///< reversed depth: nearer wins
    bool depth_clamp = false;            ///< instead of clipping at near and far
    bool color_write = true;
    bool blend = false;
    GLenum blend_equation = GL_FUNC_ADD;  ///< GL_MAX, GL_MIN, ...
    GLenum blend_source = GL_ONE, blend_target = GL_ONE;
    int row_begin = 0, row_count = 0;  ///< rows of the target that may change; row_count 0: all

    /// Writes the nearest surface into a reversed depth buffer.
    static DrawState nearest() {
        DrawState state;
        state.depth_test = state.depth_write = true;
        return state;
    }
};

void apply(const GladGLContext& gl, const DrawState& state);

}  // namespace shadow_layers
