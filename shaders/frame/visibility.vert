// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Visibility buffer: which instance.
#include "lib/scene_vertex_lib.glsl"

flat out uint v_instance;

void main() {
    v_instance = in_instance;
    gl_Position = scene_clip_position();
}
