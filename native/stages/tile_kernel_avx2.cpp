// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled for AVX2 with FMA, called only where the processor has both.
#if defined(__x86_64__)
#include <xsimd/xsimd.hpp>

namespace {
using Arch = xsimd::fma3<xsimd::avx2>;
}

#include "stages/receiver_kernel_body.h"
#include "stages/tile_kernel_body.h"

namespace shadow_layers::tile_kernel {

const Build kAvx2Build{"fma3+avx2", find_facing, place_receivers, draw_triangles};

}  // namespace shadow_layers::tile_kernel
#endif
