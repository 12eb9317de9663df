// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled for AVX2 with FMA, called only where the processor has both.
#if defined(__x86_64__)
#include <xsimd/xsimd.hpp>

namespace {
using Arch = xsimd::fma3<xsimd::avx2>;
}

#include "techniques/fsasm/facet_kernel_body.h"

namespace shadow_layers::facet_kernel {

void mask_half_plane_avx2(const Samples& samples, const LinearForm& form, double error, std::uint32_t (&mask)[kWords]) {
    cut_half_plane(samples, form.at_origin, form.by_x, form.by_y, error, mask);
}

void draw_triangles_avx2(const CasterTriangle* triangles, const std::uint32_t* order, std::size_t count, int row_begin,
                         int row_end, const PairTexels& texels, const Samples& samples, Answers& answers) {
    draw_all(triangles, order, count, row_begin, row_end, texels, samples, answers);
}

}  // namespace shadow_layers::facet_kernel
#endif
