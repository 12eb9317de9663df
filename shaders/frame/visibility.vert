// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Visibility buffer: which instance and which triangle of its mesh.
#include "lib/scene_vertex_lib.glsl"

flat out uint v_instance;
flat out uint v_triangle;

void main() {
    v_instance = in_instance;
    v_triangle = scene_triangle();
    gl_Position = scene_clip_position();
}
