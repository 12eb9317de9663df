// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace shadow_layers {

/// An interval of u or v of a view (see ReceiverScan).
struct Interval {
    double low = 0, high = 0;
    double size() const { return high - low; }
    double middle() const { return 0.5 * (low + high); }
};

/// The interval that `texel_count` texels cover, so that it holds `receivers` with at least half a texel to spare on
/// each side.
///
/// Tight, and still at rest while the camera moves: its size is one of the steps frame * 2^(-k/16) and its place a
/// whole number of texels from the middle of `frame`, an interval that does not depend on the camera (the cube face,
/// the cone, the scene's bounds). Everything is relative to `frame`, so that a scene that is scaled or moved gives the
/// same texels. Costs at most 4.4 % and two texels. Never smaller than `frame` / 2^12: beyond that, float vertices of
/// casters as large as the frame would show. Below 8 texels there is nothing to keep at rest: it is centred on the
/// receivers.
Interval fit_map_interval(const Interval& receivers, const Interval& frame, int texel_count);

}  // namespace shadow_layers
