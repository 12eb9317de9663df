// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string_view>

#include "shadow_layers/parameters.h"
#include "shadow_layers/request.h"
#include "shadow_layers/scene.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// The one spelling of the enumerations that leave the core: in snapshots, JSON, messages and Python. Lights and
/// filters are spelled as Blender has them.
const char* get_name(LightKind kind);          ///< "SUN", "SPOT", "POINT", "AREA"
const char* get_name(PixelFilterKind filter);  ///< "BOX", "GAUSSIAN", "BLACKMAN_HARRIS"
const char* get_name(ParameterType type);      ///< "bool", "int", "float", "enum"
const char* get_name(TruthKind kind);          ///< "hard", "filtered", "soft", "pixel"
const char* get_name(CasterMeshes meshes);     ///< "any", "mesh_edges", "closed"
const char* get_name(LightSize size);          ///< "ignored", "followed"

/// Nothing if there is none of that name.
std::optional<LightKind> find_light_kind(std::string_view name);
std::optional<PixelFilterKind> find_pixel_filter(std::string_view name);

/// For messages: "SUN, SPOT, POINT or AREA".
inline constexpr const char* kLightKindNames = "SUN, SPOT, POINT or AREA";
inline constexpr const char* kPixelFilterNames = "BOX, GAUSSIAN or BLACKMAN_HARRIS";

}  // namespace shadow_layers
