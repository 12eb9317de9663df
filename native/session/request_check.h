// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/engine.h"
#include "shadow_layers/request.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// A job whose words have been looked up.
struct ResolvedJob {
    std::uint32_t light = 0;
    const TechniqueDescriptor* descriptor = nullptr;
    ParameterValues parameters;
    TechniqueNeeds needs;
};

/// A request that can be worked: everything is inside the driver's limits.
struct ResolvedRequest {
    PixelRect region;
    int overscan_px = 0;  ///< the smallest of the jobs, for the pictures that belong to none
    std::vector<ResolvedJob> jobs;
};

/// Throws InputError naming the field, its value and what is allowed. `descriptors` are the techniques known.
ResolvedRequest resolve_request(const RenderRequest& request, const gl::Limits& limits,
                                const std::vector<TechniqueDescriptor>& descriptors);

}  // namespace shadow_layers
