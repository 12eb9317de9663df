// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "techniques/technique.h"

namespace shadow_layers {

TechniqueDescriptor describe_fsasm();
std::unique_ptr<Technique> make_fsasm();

}  // namespace shadow_layers
