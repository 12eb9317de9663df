// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/engine.h"
#include "frame/frame.h"
#include "lights/light_views.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

struct SoftSettings {
    int light_samples = 64;
    LightPattern pattern = LightPattern::Spiral;
    bool is_rotated = false;  ///< another shift of the pattern for each pixel of 4 x 4, and for each picture sample
    int picture_sample = 0;
};

/// Exact visibility of a light's own shape, 0 to 1 per pixel of the frame: the mean over its samples
/// (lights/light_shape.h) of what each of them lights, by the rule of occlusion_rule.h to the bit, weighted by the
/// light that the sample brings to the receiver. 0 where the receiver is turned away from all samples; 1 in the
/// background, outside the cone, and for receivers that the light is not linked to. A light without size has one
/// sample.
///
/// Counts "receivers", "light_samples", "tree_bytes", "node_tests", "leaf_tests", "open_pairs" (settled in double),
/// "lit_blocks". Times "caster_trees" and "soft_visibility".
std::vector<float> compute_soft_visibility(Engine& engine, const Frame& frame, const Light& light,
                                           const SoftSettings& settings);

}  // namespace shadow_layers
