// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lib/scene_vertex_lib.glsl"

void main() { gl_Position = scene_clip_position(); }
