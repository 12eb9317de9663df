// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What every processor of the target runs; and the choice between the builds.
#include <xsimd/xsimd.hpp>

namespace {
using Arch = xsimd::default_arch;
}

#include "techniques/fsasm/facet_kernel_body.h"

namespace shadow_layers::facet_kernel {

void mask_half_plane_base(const Samples& samples, const LinearForm& form, double error, std::uint32_t (&mask)[kWords]) {
    cut_half_plane(samples, form.at_origin, form.by_x, form.by_y, error, mask);
}

void draw_triangles_base(const CasterTriangle* triangles, const std::uint32_t* order, std::size_t count, int row_begin,
                         int row_end, const PairTexels& texels, const Samples& samples, Answers& answers) {
    draw_all(triangles, order, count, row_begin, row_end, texels, samples, answers);
}

DrawTriangles choose_draw_triangles() {
#if defined(__x86_64__)
    if (xsimd::available_architectures().fma3_avx2) return draw_triangles_avx2;
#endif
    return draw_triangles_base;
}

MaskHalfPlane choose_mask_half_plane() {
#if defined(__x86_64__)
    if (xsimd::available_architectures().fma3_avx2) return mask_half_plane_avx2;
#endif
    return mask_half_plane_base;
}

}  // namespace shadow_layers::facet_kernel
