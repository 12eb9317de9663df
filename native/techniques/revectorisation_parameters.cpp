// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/revectorisation_parameters.h"

#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {

ParameterSpec walk_limit_parameter() {
    return int_parameter("walk_limit", "Walk Limit", 16)
        .range(1, 64)
        .unit("texels")
        .help("Longest walk along a step of the border; longer steps stay as they are where their end is farther");
}

ParameterSpec channels_parameter() {
    return enum_parameter("channels", "Channels", "paper")
        .help("What becomes of light and shadow that are one texel wide")
        .item("paper", "Paper", "The paper's cases: one run for both sides")
        .item("disjoint", "Disjoint Coverage", "Each side has its own run, and what both leave over is lit");
}

std::vector<ParameterSpec> revectorisation_parameters(std::vector<ParameterSpec> own) {
    std::vector<ParameterSpec> all = {
        map_size_parameter(),
        walk_limit_parameter(),
        bool_parameter("epsilon_rule", "Slope Rule", true)
            .help("Let the depth that is compared rise with the receiver's slope along a walk, instead of keeping it"),
    };
    all.insert(all.end(), own.begin(), own.end());
    return all;
}

ParameterSpec hard_border_parameter() {
    return enum_parameter("mode", "Mode", "paper")
        .help("Where the new border lies, and how corners are cut")
        .item("paper", "Paper", "The paper's cases: from step to step, outside of the shadow map's own shadow")
        .item("reduced", "Reduced", "The author's later short form: likewise, with corners cut in one line")
        .item("half", "Half Level", "Through the middles of the steps: as much shadow is taken as is added");
}

std::string hard_border_function(const ParameterValues& values) {
    const std::string& mode = values.get_enum("mode");
    return mode == "half" ? "half_level_visibility" : mode == "reduced" ? "reduced_visibility" : "smsr_visibility";
}

bool hard_border_is_exiting(const ParameterValues& values) { return values.get_enum("mode") == "half"; }

RevectoriseSettings revectorise_settings(const ParameterValues& values, bool exiting) {
    return {.walk_limit = int(values.get_int("walk_limit")),
            .follow_slope = values.get_bool("epsilon_rule"),
            .exiting = exiting};
}

TechniqueNeeds revectorisation_needs(const ParameterValues& values) {
    return map_needs_with_margin(values, int(values.get_int("walk_limit")));
}

}  // namespace shadow_layers
