// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "shadow_layers/request.h"

namespace shadow_layers::truth {

/// A way to ask Embree: how its scene is built, and of what.
struct ShadowRayMode {
    const char* name;
    bool medium_quality;  ///< else low: the quickest to build
    bool instanced;       ///< a tree for each mesh and one over its instances; else one of all triangles
};
std::span<const ShadowRayMode> get_shadow_ray_modes();

/// What the shadows of one picture took with one mode. Visible: per pixel and light, 1 = lit, by Embree's own answer.
struct ShadowRayTimes {
    double list_ms = 0;  ///< finding the receivers that face the light
    double build_ms = 0, trace_ms = 0;
    double processor_ms = 0;  ///< of the three, all threads together
    std::size_t receivers = 0;
    std::vector<std::vector<std::uint8_t>> visible;
};

/// Hard shadows as Embree alone finds them, for the sake of its times: float triangles, packets of 16 rays, nothing
/// decided again in double (RayOracle is what is right). Bringing the vertices into place is left out of its times.
class ShadowRays {
public:
    /// `threads` <= 0: one per core.
    explicit ShadowRays(int threads);
    ~ShadowRays();
    ShadowRays(const ShadowRays&) = delete;
    ShadowRays& operator=(const ShadowRays&) = delete;

    /// The shadows of the lights that `request` has jobs for, over the receivers of `frame`: what its render gave, with
    /// "position", "normal" and "ids" among the auxiliary pictures. One sample a pixel. The scene is built again where
    /// another light has other casters.
    ShadowRayTimes measure(const RenderRequest& request, const FrameResult& frame, const ShadowRayMode& mode);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace shadow_layers::truth
