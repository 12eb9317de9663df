// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "shadow_layers/technique_descriptor.h"
#include "stages/revectorise.h"

namespace shadow_layers {

/// Parameters that revectorised techniques share: map_size, walk_limit, epsilon_rule; `own` follow.
/// Of all that walk along borders, with a filter or without.
ParameterSpec walk_limit_parameter();
/// Of all whose borders are smooth; "paper" or "disjoint".
ParameterSpec channels_parameter();

std::vector<ParameterSpec> revectorisation_parameters(std::vector<ParameterSpec> own);

/// How hard borders are cut: paper, reduced or half.
ParameterSpec hard_border_parameter();
/// The function of shaders/lib/revectorisation_lib.glsl that does it.
std::string hard_border_function(const ParameterValues& values);

/// What those parameters say; `exiting` of a mode that revectorises shadow too.
RevectoriseSettings revectorise_settings(const ParameterValues& values, bool exiting);
bool hard_border_is_exiting(const ParameterValues& values);

/// A map with a border as wide as walks reach.
TechniqueNeeds revectorisation_needs(const ParameterValues& values);

}  // namespace shadow_layers
