// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/fsasm/facet_kernel.h"

#include "base/kernel_arch.h"
#include "techniques/fsasm/facet_kernel_draw.h"

namespace shadow_layers::facet_kernel {
namespace {

void mask_half_plane(const Samples& samples, const LinearForm& form, double error, std::uint32_t (&mask)[kWords]) {
    cut_half_plane(samples, form.at_origin, form.by_x, form.by_y, error, mask);
}

}  // namespace

extern const Build SHADOW_LAYERS_OF_SET(kBuild){mask_half_plane, draw_all};

}  // namespace shadow_layers::facet_kernel
