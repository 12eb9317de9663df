// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "frame/frame.h"
#include "techniques/edtsm/pixel_camera.h"

namespace shadow_layers {

/// The frame's camera in the form of pixel_camera.h, for pixel_footprint_lib.glsl (both in shaders/techniques/edtsm/).
PixelCamera make_pixel_camera(const Frame& frame);

}  // namespace shadow_layers
