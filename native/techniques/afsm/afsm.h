// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "techniques/technique.h"

namespace shadow_layers {

TechniqueDescriptor describe_afsm();
std::unique_ptr<Technique> make_afsm();

/// Where sample `index` of `count` lies in the pixel, from its centre, in pixels: (0, 0) of one.
glm::dvec2 get_afsm_offset(int index, int count);

}  // namespace shadow_layers
