// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "techniques/edsm/edge_distance_map.h"
#include "techniques/technique.h"

namespace shadow_layers {

TechniqueDescriptor describe_edsm();
std::unique_ptr<Technique> make_edsm();

/// The edge map that edsm resolves against with these resolved parameters; for tests that look into it.
EdgeDistanceOptions edsm_edge_options(const ParameterValues& values);

}  // namespace shadow_layers
