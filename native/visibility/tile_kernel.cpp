// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/tile_kernel.h"

#include "base/instruction_set.h"
#include "base/kernel_arch.h"
#include "visibility/tile_kernel_draw.h"

namespace shadow_layers::tile_kernel {

extern const Build SHADOW_LAYERS_OF_SET(kBuild){get_name(InstructionSet::SHADOW_LAYERS_SET), find_facing,
                                                place_receivers, draw_triangles};

}  // namespace shadow_layers::tile_kernel
