// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Visibility buffer: which instance and which triangle of its mesh.
#include "lib/scene_triangle_lib.glsl"

flat in uint v_instance;
layout(location = 0) out uvec2 out_ids;

void main() { out_ids = uvec2(v_instance, scene_triangle(gl_PrimitiveID)); }
