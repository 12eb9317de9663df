// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/common_parameters.h"

#include "techniques/parameter_builder.h"

namespace shadow_layers {

ParameterSpec map_size_parameter() {
    return int_parameter("map_size", "Map Size", 1024)
        .range(1, 16384)
        .unit("texels")
        .help("Side of the square shadow map of a sun or spot light, or of each cube face of a point light")
        .shared();
}

TechniqueNeeds map_needs(const ParameterValues& values) { return map_needs_with_margin(values, 0); }

TechniqueNeeds map_needs_with_margin(const ParameterValues& values, int margin_texels) {
    TechniqueNeeds needs;
    needs.map_size = int(values.get_int("map_size"));
    needs.map_border_texels = kFootprintBorderTexels + margin_texels;
    return needs;
}

}  // namespace shadow_layers
