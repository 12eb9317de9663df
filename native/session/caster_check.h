// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/engine.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// Where the technique needs closed meshes: warns of each open one that casts for the light, naming both. The meshes'
/// edges, which such a technique asks for anyhow, come from the cache.
void warn_of_open_casters(Engine& engine, const TechniqueDescriptor& technique, const Scene& scene, const Light& light);

}  // namespace shadow_layers
