// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Attribute locations of programs that draw_scene (engine/scene_draw.h) drives.

#ifdef __cplusplus
namespace shadow_layers {
#endif

const int kSlotPosition = 0;    // vec3, per vertex: object space, about the mesh's centre
const int kSlotClipMatrix = 1;  // mat4 (takes 1..4), per instance: clip space from position above
const int kSlotInstance = 5;    // uint, per instance: index into Scene::instances

#ifdef __cplusplus
}  // namespace shadow_layers
#endif
