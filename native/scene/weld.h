// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace shadow_layers {

/// Per vertex the lowest number of a vertex at exactly the same place; -0 equals 0. A vertex that is not usable
/// (scene/bounds.h) is welded to nothing.
std::vector<std::uint32_t> weld_vertices(std::span<const glm::vec3> positions);

/// Is `weld` what weld_vertices(positions) gives? For usable vertices only. Exact; cheaper than welding: members are
/// compared with their class, and classes are kept apart by a bitmap of hashes, of which few hits need a closer look.
bool weld_still_holds(std::span<const std::uint32_t> weld, std::span<const glm::vec3> positions);

}  // namespace shadow_layers
