// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "shadow_layers/scene.h"
#include "visibility/soft_kernel.h"

namespace shadow_layers {

/// By how much boxes are made larger: as a part of their coordinates, and in scene units.
struct BoxWidening {
    double relative = 0, absolute = 0;
};

/// Of a box's coordinates: its rounding to float and that of what is computed from it.
inline constexpr double kBoxRounding = 8.0 / 16777216;  // 2^-21

/// A node without children.
soft_kernel::Node make_empty_node();

/// Child `i` of the node: its box, widened, and its link.
void set_box(soft_kernel::Node& node, int i, const Bounds& box, const BoxWidening& widening, std::uint32_t link);

}  // namespace shadow_layers
