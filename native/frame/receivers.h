// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "base/thread_pool.h"
#include "frame/camera_window.h"
#include "frame/frame.h"

namespace shadow_layers {

/// The plane of a triangle about the camera, and the span of view depths of its corners.
struct TrianglePlane {
    glm::dvec3 normal{0.0};  ///< unit, turned to the camera; zero if the triangle has no area
    double distance = 0;     ///< normal . p = distance for p_rel on the plane
    double near_vs = 0, far_vs = 0;
};

/// In double throughout. `camera_position` is the origin of the space "_rel".
TrianglePlane compute_triangle_plane(const Scene& scene, const PixelIds& ids, const Camera& camera);

/// Pixels for the GL textures of the frame: see Frame::position_tx and normal_tx.
struct ReceiverTexels {
    std::span<glm::vec4> positions, normals;
};

/// From `frame.ids`: positions_rel, normals, coverage, and the texels (all of the frame's size). Each position is where
/// the pixel centre's ray meets the plane of its triangle, so the pixels of one face lie in one plane; a ray that
/// misses an edge-on triangle's plane is held within the depths of its corners.
void resolve_receivers(ThreadPool& threads, Frame& frame, const ReceiverTexels& texels);

}  // namespace shadow_layers
