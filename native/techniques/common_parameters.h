// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// Parameters that techniques built on a depth map share.
ParameterSpec map_size_parameter();

/// Texels that 2 x 2 lookups may reach over the rim of a view. sm, pcf with one tap and edsm ask for the same border,
/// so that they share views and depth maps.
inline constexpr int kFootprintBorderTexels = 2;

/// What a technique on maps of `map_size` needs whose lookups stay in their 2 x 2 footprint, or go `margin_texels`
/// beyond it on each side.
TechniqueNeeds map_needs(const ParameterValues& values);
TechniqueNeeds map_needs_with_margin(const ParameterValues& values, int margin_texels);

}  // namespace shadow_layers
