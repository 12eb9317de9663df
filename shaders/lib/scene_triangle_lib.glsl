// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// For fragment and geometry shaders that draw_scene drives: which triangle of the mesh this is.
#include "shared/scene_slots.h"

layout(location = kSlotTriangleBase) uniform uint u_triangle_base;

uint scene_triangle(int primitive_id) { return u_triangle_base + uint(primitive_id); }
