// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shadow_layers/technique_descriptor.h"
#include "stages/revectorised_filter.h"

namespace shadow_layers {

/// Parameters that both revectorised filters share: map_size, kernel, walk_limit, spacing, early_out; `own` follow.
std::vector<ParameterSpec> revectorised_filter_parameters(std::vector<ParameterSpec> own);

/// What those parameters say.
RevectorisedFilterSettings revectorised_filter_settings(const ParameterValues& values);

/// The square that the taps stand for: each is the middle of a cell of `spacing` texels.
TruthSpec revectorised_filter_truth(const ParameterValues& values);

}  // namespace shadow_layers
