// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "shadow_layers/request.h"
#include "shadow_layers/session.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers::cli {

/// The techniques with their parameters as text for the help: all from the descriptors.
std::string describe_techniques();

/// The parts that all JSON documents are made of.
nlohmann::json versions_to_json(const SessionInfo& info);
nlohmann::json technique_to_json(const TechniqueDescriptor& descriptor);
nlohmann::json parameters_to_json(const ParameterValues& values);

/// Milliseconds by stage, CPU wall time or GL timer; stages without such a time are left out.
nlohmann::json cpu_times_to_json(const RenderStats& stats);
nlohmann::json gl_times_to_json(const RenderStats& stats);

/// Rounded for reading.
double round_ms(double ms);

}  // namespace shadow_layers::cli
