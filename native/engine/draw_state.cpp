// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/draw_state.h"

#include <limits>

namespace shadow_layers {
namespace {

void set_capability(const GladGLContext& gl, GLenum capability, bool on) {
    if (on)
        gl.Enable(capability);
    else
        gl.Disable(capability);
}

}  // namespace

void apply(const GladGLContext& gl, const DrawState& state) {
    set_capability(gl, GL_DEPTH_TEST, state.depth_test);
    set_capability(gl, GL_DEPTH_CLAMP, state.depth_clamp);
    set_capability(gl, GL_BLEND, state.blend);
    gl.Disable(GL_CULL_FACE);
    set_capability(gl, GL_SCISSOR_TEST, state.row_count > 0);
    if (state.row_count > 0) gl.Scissor(0, state.row_begin, std::numeric_limits<GLsizei>::max(), state.row_count);
    gl.DepthFunc(state.depth_function);
    gl.DepthMask(state.depth_write ? GL_TRUE : GL_FALSE);
    const GLboolean color = state.color_write ? GL_TRUE : GL_FALSE;
    gl.ColorMask(color, color, color, color);
    if (!state.blend) return;
    gl.BlendEquation(state.blend_equation);
    gl.BlendFunc(state.blend_source, state.blend_target);
}

}  // namespace shadow_layers
