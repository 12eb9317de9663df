// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lights/map_fit.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

class ThreadPool;

/// Does the instance cast shadows for this light?
inline bool casts_for(const Light& light, const Instance& instance) {
    return (instance.flags & kInstanceShadow) && (light.blocker_set >> instance.blocker_group & 1u);
}

/// What a view's map sees, border included: a pyramid from the light, or an orthographic box without a near end.
struct ViewRegion {
    bool perspective = true;
    glm::dmat4 ls_from_ws{1.0};
    Interval u, v;         ///< as in ReceiverScan
    double depth_max = 0;  ///< of the receivers, with a margin: what lies beyond casts on nothing
};

struct ViewCasters {
    std::vector<std::uint32_t> instances;  ///< ascending
    double nearest = 0;  ///< depth of the nearest point of their bounds within the region; depth_max if there is none
};

/// Instances that cast for `light` and whose bounds reach the region.
ViewCasters find_view_casters(const Scene& scene, const Light& light, const ViewRegion& region, ThreadPool* threads);

}  // namespace shadow_layers
