// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What every processor of the target runs; and the choice between the builds.
#include <xsimd/xsimd.hpp>

namespace {
using Arch = xsimd::default_arch;
}

#include "stages/tile_kernel_body.h"

namespace shadow_layers::tile_kernel {

void draw_triangles_base(const CasterTriangle* triangles, const std::uint32_t* order, std::size_t count, int row_begin,
                         int row_end, Tiles& tiles, Answers& answers) {
    draw_all(triangles, order, count, row_begin, row_end, tiles, answers);
}

DrawTriangles choose_draw_triangles(const char** name) {
    const char* chosen = Arch::name();
    DrawTriangles draw = draw_triangles_base;
#if defined(__x86_64__)
    if (xsimd::available_architectures().fma3_avx2) {
        chosen = "fma3+avx2";
        draw = draw_triangles_avx2;
    }
#endif
    if (name) *name = chosen;
    return draw;
}

}  // namespace shadow_layers::tile_kernel
