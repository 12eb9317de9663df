// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "shadow_layers/parameters.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

/// One output channel group. "visibility" (1 channel, 1 = lit) is always the first.
struct OutputSpec {
    std::string id;     ///< snake_case
    std::string label;  ///< pass name part; empty for "visibility"
    int channels = 1;   ///< 1, 3 or 4
    std::string help;
};

/// What a technique needs around it, as a function of its parameters.
struct TechniqueNeeds {
    int map_size = 0;           ///< texels per side of each view's map, without border; 0: no views are made
    int map_border_texels = 0;  ///< extra texels on each side of each view, for kernels that reach over its rim
    int overscan_px = 0;        ///< extra frame pixels on each side of the region (camera-space stages)
    int light_positions = 1;    ///< positions sampled on the light's shape; 1 = its centre
};

/// A technique as data: everything that the rest of the product knows of it.
struct TechniqueDescriptor {
    std::string id;         ///< lower case; names folder, shaders, passes, docs page, benchmark row
    std::string label;      ///< short name for menus
    std::string summary;    ///< one sentence
    std::string reference;  ///< bib key and section in docs/references.bib
    std::vector<ParameterSpec> parameters;
    std::vector<OutputSpec> outputs;  ///< outputs[0].id == "visibility"
    std::vector<LightKind> lights;    ///< kinds served
    std::string limits;               ///< one sentence: when it fails
    bool test_only = false;           ///< not offered to users (probe)
    std::function<TechniqueNeeds(const ParameterValues&)> needs;
};

/// All registered techniques in menu order.
const std::vector<TechniqueDescriptor>& technique_descriptors();

/// InputError listing the known ids if there is none.
const TechniqueDescriptor& find_technique_descriptor(std::string_view id);
const TechniqueDescriptor& find_technique_descriptor(const std::vector<TechniqueDescriptor>& among,
                                                     std::string_view id);

}  // namespace shadow_layers
