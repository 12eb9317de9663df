// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/revectorised_filter_parameters.h"

#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"
#include "techniques/revectorisation_parameters.h"

namespace shadow_layers {

std::vector<ParameterSpec> revectorised_filter_parameters(std::vector<ParameterSpec> own) {
    std::vector<ParameterSpec> all = {
        map_size_parameter(),
        int_parameter("kernel", "Kernel", 3)
            .range(1, 31)
            .unit("taps")
            .help("Revectorised visibilities per side of the square kernel; 1 is the technique without a filter"),
        walk_limit_parameter(),
        int_parameter("spacing", "Spacing", 1)
            .range(1, 8)
            .unit("texels")
            .help("Distance from tap to tap; 1 is the paper's, more widens the kernel at the price of bands"),
        bool_parameter("early_out", "Early Out", true)
            .help(
                "Work out at once what taps have in common, and skip pixels whose tests all agree for sure; off: each "
                "tap on its own, which gives the same picture"),
    };
    all.insert(all.end(), own.begin(), own.end());
    return all;
}

RevectorisedFilterSettings revectorised_filter_settings(const ParameterValues& values) {
    RevectorisedFilterSettings settings;
    settings.kernel = int(values.get_int("kernel"));
    settings.spacing_texels = int(values.get_int("spacing"));
    settings.walk_limit = int(values.get_int("walk_limit"));
    settings.early_out = values.get_bool("early_out");
    return settings;
}

TruthSpec revectorised_filter_truth(const ParameterValues& values) {
    return {.kind = TruthKind::Filtered,
            .footprint_texels = double(values.get_int("kernel") * values.get_int("spacing"))};
}

}  // namespace shadow_layers
