// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tiny_gltf.h>

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace shadow_layers::io {

/// VEC3 of any component type, normalized or not, interleaved or not, sparse or not. FileError with `place` for
/// accessors that reach outside their buffer view, or views outside their buffer.
std::vector<glm::vec3> read_vec3_accessor(const tinygltf::Model& model, int accessor, const std::string& place);

/// SCALAR of an unsigned component type.
std::vector<std::uint32_t> read_index_accessor(const tinygltf::Model& model, int accessor, const std::string& place);

}  // namespace shadow_layers::io
