// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The depth range map: what a block of texels, and the blocks within reach of it, hold.

#ifdef __cplusplus
namespace shadow_layers {
#endif

const int kRangeBlockTexels = 4;  // texels per side of a block
const int kDepthRangeUnit = 4;    // least and greatest depth_rz within reach; depth_rz of the block's own base texel
const int kDepthStepsUnit = 5;    // least and greatest step of depth_rz from a texel to the next, along x and along y

#ifdef __cplusplus
}  // namespace shadow_layers
#endif
