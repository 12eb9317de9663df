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

/// How Embree is asked: how its scene is built, and of what.
struct ShadowRayMode {
    const char* name;
    bool medium_quality;  ///< else low: the quickest to build
    bool instanced;       ///< a tree for each mesh and one over its instances; else one of all triangles
};
std::span<const ShadowRayMode> get_shadow_ray_modes();

/// What the shadows of one picture took with one mode.
struct ShadowRayTimes {
    double list_ms = 0;  ///< finding the receivers that face some sample of the light
    double build_ms = 0;
    double packets_ms = 0, stream_ms = 0;  ///< all rays, in packets of 16 (rtcOccluded16), and again by rtcOccluded1M
    double processor_ms = 0;               ///< of list, build and packets, all threads together
    std::size_t receivers = 0, rays = 0;
    /// Per light and pixel: how many samples the pixel faces and sees, by Embree's own answer (its packets').
    std::vector<std::vector<std::uint16_t>> lit;
    std::size_t disagreements = 0;  ///< rays that the stream answers otherwise
};

/// Shadows as Embree alone finds them, for the sake of its times: float triangles, nothing decided again in double
/// (RayOracle is what is right). Bringing the vertices into place is left out of its times.
class ShadowRays {
public:
    /// `threads` <= 0: one per core.
    explicit ShadowRays(int threads);
    ~ShadowRays();
    ShadowRays(const ShadowRays&) = delete;
    ShadowRays& operator=(const ShadowRays&) = delete;

    /// The shadows of the lights that `request` has jobs for, over the receivers of `frame`: what its render gave, with
    /// "position", "normal" and "ids" among the auxiliary pictures. One place a pixel, and from it a ray to each sample
    /// of the light that the job's technique takes, which the place faces; jobs that take the same samples are one. The
    /// scene is built again where another light has other casters.
    ShadowRayTimes measure(const RenderRequest& request, const FrameResult& frame, const ShadowRayMode& mode);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace shadow_layers::truth
