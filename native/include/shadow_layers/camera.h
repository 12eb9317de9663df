// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace shadow_layers {

/// A rectangle of window space at view depth 1 (perspective) or in scene units (orthographic).
struct CameraWindow {
    double left = -1, right = 1, bottom = -1, top = 1;
};

/// A pinhole or orthographic camera. Looks along its local -Z, +Y up. The window carries field of view, sensor fit,
/// shift and pixel aspect, so that jitter, crop and overscan are plain moves of the window, exact in double.
struct Camera {
    bool perspective = true;
    CameraWindow window;                ///< of the full picture: pixel (0,0)'s lower left corner to the upper right one
    double clip_start = 0.1;            ///< > 0 for perspective; along -Z, scene units
    double clip_end = 1000.0;           ///< > clip_start
    glm::dmat4 world_from_camera{1.0};  ///< orthonormal axes, no scale
};

/// Throws InputError naming the field: not finite, empty window, clip_end <= clip_start, scaled axes.
void validate(const Camera& camera);

/// Pixels of the full picture, origin at the lower left corner, row 0 at the bottom.
struct PixelRect {
    int x = 0, y = 0, width = 0, height = 0;
};

}  // namespace shadow_layers
