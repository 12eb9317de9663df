// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a picture of nearest sites (shared/nearest_site.h). Pixels are integer coordinates, row 0 at the bottom.
#pragma once

#include "shared/nearest_site.h"

bool is_site(uint packed_site) { return packed_site != kNoSite; }

/// The site's pixel; not to be asked of kNoSite.
ivec2 unpack_site(uint packed_site) { return ivec2(packed_site & 0xFFFFu, packed_site >> 16); }

uint pack_site(ivec2 site) { return uint(site.y) << 16 | uint(site.x); }

/// Squared distance between the centres of two pixels, exact.
int squared_distance(ivec2 a, ivec2 b) {
    ivec2 apart = a - b;
    return apart.x * apart.x + apart.y * apart.y;
}
