// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Moment maps: what their makers and their readers agree on.

#ifdef __cplusplus
namespace shadow_layers {
#endif

const int kMomentMapUnit = 2;    // texture unit in the resolve passes, which need no depth map
const int kMostBlurTexels = 32;  // radius of the widest blur

#ifdef __cplusplus
}  // namespace shadow_layers
#endif
