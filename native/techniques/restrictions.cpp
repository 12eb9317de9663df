// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "shadow_layers/names.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

std::vector<std::string> list_restrictions(const TechniqueDescriptor& technique) {
    std::vector<std::string> restrictions;
    const auto add = [&](bool holds, const char* text) {
        if (holds) restrictions.emplace_back(text);
    };
    add(technique.meshes == CasterMeshes::Closed, "Casters must be closed meshes");
    add(technique.meshes == CasterMeshes::MeshEdges,
        "Borders are refined at the edges of meshes, not where surfaces cut each other");
    const bool can_be_soft = std::any_of(technique.parameters.begin(), technique.parameters.end(),
                                         [](const ParameterSpec& spec) { return spec.id == "light_samples"; });
    add(technique.light_size == LightSize::Ignored,
        can_be_soft ? "Lights count as having no size while light_samples is 1" : "Lights count as having no size");
    add(!technique.alpha_cutouts, "Holes that a material's alpha cuts count as opaque");
    if (technique.lights.size() < TechniqueDescriptor().lights.size()) {
        std::string kinds;
        for (const LightKind kind : technique.lights)
            kinds += (kinds.empty() ? "" : ", ") + std::string(get_name(kind));
        restrictions.push_back("Serves these lights only: " + kinds);
    }
    return restrictions;
}

}  // namespace shadow_layers
