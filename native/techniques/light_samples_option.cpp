// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/light_samples_option.h"

namespace shadow_layers {

ParameterBuilder light_pattern_parameter(std::string id, std::string label) {
    return enum_parameter(std::move(id), std::move(label), "spiral")
        .help("How the points are spread over the light's shape")
        .item("spiral", "Spiral", "A lattice made for the number of points; a sunflower on discs")
        .item("sequence", "Sequence", "An additive sequence, even at any number of points")
        .item("grid", "Grid", "Middles of cells of equal area; straight borders show its rows as bands")
        .item("random", "Random", "Independent points, to see what evenness is worth");
}

LightPattern read_light_pattern(const ParameterValues& values, std::string_view parameter) {
    const std::string& id = values.get_enum(parameter);
    if (id == "spiral") return LightPattern::Spiral;
    if (id == "grid") return LightPattern::Grid;
    if (id == "random") return LightPattern::Random;
    return LightPattern::Sequence;
}

bool can_average_light_samples(const TechniqueDescriptor& technique) {
    // Without the descriptor's `check`, which may look other techniques up while the list of them is made.
    const ParameterValues defaults = resolve_parameters(technique.id, technique.parameters, {});
    return find_truth(technique, defaults).kind == TruthKind::Hard;
}

void add_light_samples_option(TechniqueDescriptor& technique) {
    technique.parameters.push_back(int_parameter("light_samples", "Light Samples", 1)
                                       .range(1, kMostLightSamples)
                                       .help("Points on the light's shape, each a hard shadow of its own, that are "
                                             "averaged to a soft one; 1 is its centre")
                                       .shared());
    technique.parameters.push_back(light_pattern_parameter("light_pattern", "Light Pattern").shared());
    technique.needs = [needs = technique.needs](const ParameterValues& values) {
        TechniqueNeeds all = needs ? needs(values) : TechniqueNeeds{};
        all.light_samples = int(values.get_int("light_samples"));
        all.light_pattern = read_light_pattern(values, "light_pattern");
        return all;
    };
    technique.truth = [truth = technique.truth](const ParameterValues& values) {
        if (values.get_int("light_samples") > 1) return TruthSpec{TruthKind::Soft};
        return truth ? truth(values) : TruthSpec{};
    };
}

}  // namespace shadow_layers
