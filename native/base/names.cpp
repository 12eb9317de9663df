// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "shadow_layers/names.h"

#include <array>

namespace shadow_layers {
namespace {

// In the order of the enumerators.
constexpr std::array<const char*, 4> kLightKinds = {"SUN", "SPOT", "POINT", "AREA"};
constexpr std::array<const char*, 3> kPixelFilters = {"BOX", "GAUSSIAN", "BLACKMAN_HARRIS"};
constexpr std::array<const char*, 4> kTruthKinds = {"hard", "filtered", "soft", "pixel"};
constexpr std::array<const char*, 3> kCasterMeshes = {"any", "mesh_edges", "closed"};
constexpr std::array<const char*, 2> kLightSizes = {"ignored", "followed"};
constexpr std::array<const char*, 4> kParameterTypes = {"bool", "int", "float", "enum"};
static_assert(int(LightKind::Area) == 3 && int(PixelFilterKind::BlackmanHarris) == 2 && int(ParameterType::Enum) == 3 &&
              int(TruthKind::Pixel) == 3 && int(CasterMeshes::Closed) == 2 && int(LightSize::Followed) == 1);

template <class Names, class Enum>
const char* name_of(const Names& names, Enum value) {
    return std::size_t(value) < names.size() ? names[std::size_t(value)] : "unknown";
}

template <class Enum, class Names>
std::optional<Enum> find_name(const Names& names, std::string_view name) {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (name == names[i]) return Enum(i);
    return std::nullopt;
}

}  // namespace

const char* get_name(LightKind kind) { return name_of(kLightKinds, kind); }
const char* get_name(PixelFilterKind filter) { return name_of(kPixelFilters, filter); }
const char* get_name(ParameterType type) { return name_of(kParameterTypes, type); }
const char* get_name(TruthKind kind) { return name_of(kTruthKinds, kind); }
const char* get_name(CasterMeshes meshes) { return name_of(kCasterMeshes, meshes); }
const char* get_name(LightSize size) { return name_of(kLightSizes, size); }

std::optional<LightKind> find_light_kind(std::string_view name) { return find_name<LightKind>(kLightKinds, name); }
std::optional<PixelFilterKind> find_pixel_filter(std::string_view name) {
    return find_name<PixelFilterKind>(kPixelFilters, name);
}

}  // namespace shadow_layers
