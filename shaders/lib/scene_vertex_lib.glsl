// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inputs of a vertex shader that draw_scene drives. Usage: gl_Position = scene_clip_position();
#include "shared/scene_slots.h"

layout(location = kSlotPosition) in vec3 in_position;
layout(location = kSlotClipMatrix) in mat4 in_clip_from_position;
layout(location = kSlotInstance) in uint in_instance;

vec4 scene_clip_position() { return in_clip_from_position * vec4(in_position, 1.0); }

// Only for draws with SceneDraw::numbered, and only as a flat output: see GpuMesh in engine/mesh_cache.h.
uint scene_triangle() { return uint(gl_VertexID); }
