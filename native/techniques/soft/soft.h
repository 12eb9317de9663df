// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "techniques/technique.h"

namespace shadow_layers {

TechniqueDescriptor describe_soft();
std::unique_ptr<Technique> make_soft();

}  // namespace shadow_layers
