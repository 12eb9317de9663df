// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Second of two programs, by the book: [Macedo16] Eq. 2 or 3 for each tap of the kernel.
// Defines: those of inputs.glsl. A reference: software rasterisers end loops after 65,536 trips in all, which kernels of
// more than some 20 taps a side would need.
#include "stages/revectorised_filter/tap.glsl"

layout(location = 0) out float visibility;

void main() {
    fetch_kernel(ivec2(gl_FragCoord.xy));
    float sum = 0.0;
    for (int k = 0; k < KERNEL * KERNEL; ++k)
        sum += evaluate_tap(kernel.first + SPACING * ivec2(k % KERNEL, k / KERNEL));
    float count = float(KERNEL * KERNEL);
    visibility = combine_visibility(kernel.receiver, kernel.layer, sum == count ? 1.0 : min(sum / count, 1.0));
}
