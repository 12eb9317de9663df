// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/common_parameters.h"

namespace shadow_layers {

ParameterSpec map_size_parameter() {
    ParameterSpec spec;
    spec.id = "map_size";
    spec.label = "Map Size";
    spec.type = ParameterType::Int;
    spec.default_value = std::int64_t{1024};
    spec.min = 1;
    spec.max = 16384;
    spec.unit = "texels";
    spec.help = "Side of the square shadow map of a sun or spot light, or of each cube face of a point light";
    spec.shared = true;
    return spec;
}

TechniqueNeeds map_needs(const ParameterValues& values, int reach_texels) {
    TechniqueNeeds needs;
    needs.map_size = int(values.get_int("map_size"));
    needs.map_border_texels = kFootprintBorderTexels + reach_texels;
    return needs;
}

std::vector<LightKind> all_light_kinds() {
    return {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area};
}

std::vector<OutputSpec> visibility_output() { return {{"visibility", "", 1, "1 = lit, 0 = in shadow"}}; }

}  // namespace shadow_layers
