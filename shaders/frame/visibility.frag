// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Visibility buffer: which instance and which triangle of its mesh.
flat in uint v_instance;
flat in uint v_triangle;
layout(location = 0) out uvec2 out_ids;

void main() { out_ids = uvec2(v_instance, v_triangle); }
