// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What every processor of the target runs; and the choice between the builds.
#include <xsimd/xsimd.hpp>

namespace {
#if defined(__x86_64__)
using Arch = xsimd::sse2;
#else
using Arch = xsimd::default_arch;
#endif
}  // namespace

#include "stages/receiver_kernel_body.h"
#include "stages/tile_kernel_body.h"

namespace shadow_layers::tile_kernel {

const Build kBaseBuild{Arch::name(), find_facing, place_receivers, draw_triangles};

const Build& choose_build() {
#if defined(__x86_64__)
    if (xsimd::available_architectures().fma3_avx2) return kAvx2Build;
#endif
    return kBaseBuild;
}

}  // namespace shadow_layers::tile_kernel
