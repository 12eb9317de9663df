// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lights/light_views.h"
#include "shadow_layers/request.h"

namespace shadow_layers {

/// What a layer tells of the views of a light sample.
std::vector<MapView> describe_views(const LightSample& sample);

}  // namespace shadow_layers
