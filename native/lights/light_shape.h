// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lights/light_views.h"
#include "lights/sample_pattern.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// The samples (points; of a sun: directions) that stand for a light, without views; the same ones each time. One: its
/// centre. More: equal shares of the light as Cycles emits it. A light without size has one, whatever the count.
///
/// - Area: even over the rectangle or ellipse.
/// - Sun: even in solid angle over the cone of its angle.
/// - Point and spot: Cycles has a disc turned to the receiver, or a sphere (its soft falloff switched off), which from
///   outside is a disc of even brightness as well. One set of points must do for all receivers, so it fills the ball
///   with a density that looks like an even disc from every side; that of a sphere's surface would look brighter
///   towards the rim, that of an even ball towards the middle.
///
/// `shift` (find_pattern_shifts) makes other points of the same shape.
std::vector<LightSample> sample_light_shape(const Light& light, int count,
                                            LightPattern pattern = LightPattern::Sequence,
                                            const PatternShift& shift = {});

/// Full angle (radians) of the round cone that holds all of a spot's cone, which may be wider along x or y.
double find_widest_spot_angle(const Light& light);

/// Right-handed and orthonormal, z as in `matrix`; a mirrored or slightly skewed light keeps its direction.
glm::dmat3 compute_light_axes(const glm::dmat4& matrix);

}  // namespace shadow_layers
