// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "frame/frame.h"
#include "pixel_camera.h"

namespace shadow_layers {

/// The frame's camera in the form of shaders/shared/pixel_camera.h, for lib/pixel_footprint_lib.glsl.
PixelCamera make_pixel_camera(const Frame& frame);

}  // namespace shadow_layers
