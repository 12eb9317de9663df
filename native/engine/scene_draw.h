// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "engine/engine.h"
#include "engine/mesh_cache.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

/// Instances to draw under any matrix. Matrices are composed in double per instance (clip_from_ws * world_from_object *
/// mesh centre) and then rounded, so that offsets of 1e6 cancel before they cost precision.
struct SceneDraw {
    const Scene& scene;
    std::span<const std::uint32_t> instances;  ///< indices into scene.instances, in any order
    glm::dmat4 clip_from_ws{1.0};
    bool numbered = false;  ///< the program calls scene_triangle(); costs a little
};

/// Draws into the bound framebuffer with `program` and `state`; each mesh is one draw for all its instances.
///
/// The program's vertex shader includes "lib/scene_vertex_lib.glsl" and starts from `scene_clip_position()`;
/// `in_instance` is the index into Scene::instances (hand it on as `flat out uint`). With `numbered`,
/// `scene_triangle()` is the triangle of the mesh, where it is handed on as `flat out uint` too (a fragment gets the
/// last corner's value).
///
/// Long draws are cut into pieces with cancel checks between them (throws Cancelled). Counts "triangles" in the record.
void draw_scene(Engine& engine, const gl::Program& program, const DrawState& state, const SceneDraw& draw);

}  // namespace shadow_layers
