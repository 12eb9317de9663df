// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The exact rays of native/truth/, as tests call them.

#include "truth/ray_oracle.h"

namespace shadow_layers::testing {

using truth::compute_pixel_ray;
using truth::PixelRay;
using truth::RayHit;
using truth::RayOracle;

}  // namespace shadow_layers::testing
