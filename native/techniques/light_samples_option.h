// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shadow_layers/technique_descriptor.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {

/// Finer steps than 1 / 256 are lost in pictures of 8 bits.
inline constexpr int kMostLightSamples = 256;

/// How samples are spread over the light's shape, under the given id.
ParameterBuilder light_pattern_parameter(std::string id, std::string label);
LightPattern read_light_pattern(const ParameterValues& values, std::string_view id);

/// Soft shadows as an option of a technique for hard ones, by its default truth: the session averages its layers over
/// `light_samples` points of the light's shape.
bool can_average_light_samples(const TechniqueDescriptor& technique);

/// Adds `light_samples` and `light_pattern`, and what they mean for `needs` and `truth`.
void add_light_samples_option(TechniqueDescriptor& technique);

}  // namespace shadow_layers
