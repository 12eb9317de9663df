// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a pixel's record says of the texel that its receiver lies in.
#include "techniques/smsr2/discontinuity_map.h"

const uint kCodeBits = 31u;
const uint kMapDecidesBit = 32u;

uint place_bits(ivec2 texel, int layer) {
    uvec2 low = uvec2(texel) & uvec2(kPlaceMask);
    return kMapDecidesBit | (uint(layer) << kLayerShift) | (low.x << kColumnShift) | (low.y << kRowShift);
}
