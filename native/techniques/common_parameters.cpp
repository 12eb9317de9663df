// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/common_parameters.h"

#include "shadow_layers/error.h"

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

std::vector<LightKind> all_light_kinds() { return {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}; }

std::vector<OutputSpec> visibility_output() {
    return {{"visibility", "", 1, "1 = lit, 0 = in shadow"}};
}

void check_map_size(const Engine& engine, const TechniqueDescriptor& technique, const ParameterValues& parameters) {
    const TechniqueNeeds needs = technique.needs(parameters);
    const int side = needs.map_size + 2 * needs.map_border_texels;
    const int limit = engine.limits().max_texture_size;
    if (side <= limit) return;
    throw InputError(technique.id + ": map_size " + std::to_string(needs.map_size) + " with a border of " +
                     std::to_string(needs.map_border_texels) + " texels is larger than this GL driver's limit of " +
                     std::to_string(limit) + " (" + engine.device().renderer() + "); set map_size to at most " +
                     std::to_string(limit - 2 * needs.map_border_texels));
}

}  // namespace shadow_layers
