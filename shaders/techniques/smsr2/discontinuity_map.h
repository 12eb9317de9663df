// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The picture of discontinuities: for each pixel, the code of its map texel and enough of the texel's place to tell
// whether it is the one looked for.

#ifdef __cplusplus
namespace shadow_layers {
#endif

const int kDiscontinuityUnit = 3;  // texture unit

// R32UI: bits 0-4 code, 5 the map decides here, 6-8 layer, 9-19 and 20-30 lowest bits of the texel's column and row.
const int kLayerShift = 6;
const int kColumnShift = 9;
const int kRowShift = 20;
const int kPlaceMask = 2047;  // more than two walks of the longest kind, so no texel within reach is mistaken

#ifdef __cplusplus
}  // namespace shadow_layers
#endif
