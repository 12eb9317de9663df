// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A picture of nearest sites: y << 16 | x of the nearest site in pixels, or kNoSite. Compiled by C++ and by GLSL.

#ifdef __cplusplus
#include <cstdint>
namespace shadow_layers {
using uint = std::uint32_t;
#endif

const uint kNoSite = 0xFFFFFFFFu;  // the picture has no site, or none within the bound
const int kLargestTransformSide = 16384;
const int kFarthestTransformDistance = 32767;  // more than the diagonal; its square fits an int

#ifdef __cplusplus
}  // namespace shadow_layers
#endif
