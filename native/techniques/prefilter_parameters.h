// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "gl/program.h"
#include "shadow_layers/technique_descriptor.h"
#include "stages/moment_map.h"

namespace shadow_layers {

/// Parameters that techniques on moment maps share: map_size, blur_radius, filter, mipmaps, anisotropy and bits (32 or
/// 16 per component); `own` follow.
std::vector<ParameterSpec> prefilter_parameters(std::vector<ParameterSpec> own);

/// What several of them have among their own.
ParameterSpec bleed_reduction_parameter(double default_value);

/// What those parameters say; encoding, format and exponents are the technique's to fill in.
MomentMapOptions prefilter_options(const ParameterValues& values);
bool has_16_bits(const ParameterValues& values);

/// Defines of shaders/stages/moment_inputs.glsl.
gl::Defines prefilter_defines(const ParameterValues& values);

/// A map with a border as wide as blur and mipmaps reach.
TechniqueNeeds prefilter_needs(const ParameterValues& values);

/// The exact mask over the square of the blur's variance, a texel of the map wider for the texel itself: (2 r + 1)
/// texels for a box of radius r.
TruthSpec prefilter_truth(const ParameterValues& values);

/// An exponent: 0 stands for `automatic`. Refuses one that the format has no room for.
void check_exponent(const std::string& technique, const std::string& parameter, const ParameterValues& values,
                    double most_16_bits);
double choose_exponent(const ParameterValues& values, const std::string& parameter, double automatic_32_bits,
                       double automatic_16_bits);

}  // namespace shadow_layers
