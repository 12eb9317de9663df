// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lights/light_views.h"

namespace shadow_layers {

/// The points (sun: directions) that stand for a light, without views. One: its centre. More: spread evenly and the
/// same way each time over the sphere of a point or spot light, the face of an area light, the disc of the sun.
std::vector<LightPosition> sample_light_shape(const Light& light, int position_count);

/// Right-handed and orthonormal, z as in `matrix`; a mirrored or slightly skewed light keeps its direction.
glm::dmat3 compute_light_axes(const glm::dmat4& matrix);

}  // namespace shadow_layers
