// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "truth/ray_oracle.h"

namespace shadow_layers::truth {

/// What a place in a pixel receives the light with.
enum class SampleReceiver : std::uint8_t {
    OwnRay,       ///< what the camera sees there
    CentreFacet,  ///< the plane of the triangle that the pixel's centre sees, endless, where the place's ray meets it
};

/// Exact hard visibility at any place in any pixel of a frame, for one position of a light.
class PixelSamples {
public:
    /// All must outlive this. The frame needs camera, size, origin, scene, and what its pixels' centres see.
    PixelSamples(const RayOracle& oracle, const Frame& frame, const Light& light, const LightSample& position);

    /// For each offset (dx, dy), in pixels from the pixel's centre: 1 = lit, 0 = in shadow or turned away. Each place
    /// goes by the rule of light_rule.h for itself: 1 in the background, outside the cone and unlinked. With
    /// CentreFacet all places of a pixel whose centre sees background are background, and a ray that misses the plane
    /// is lit. May be called by many threads.
    std::vector<std::uint8_t> find_visibility(std::size_t pixel, std::span<const glm::dvec2> offsets_px,
                                              SampleReceiver receiver) const;

private:
    /// What the camera sees along the ray.
    std::optional<RayHit> see(const PixelRay& ray) const;
    /// Where the ray meets the plane of the pixel's triangle before the camera.
    std::optional<RayHit> meet_facet(const PixelRay& ray, std::size_t pixel) const;
    bool is_lit(const PixelRay& ray, const std::optional<RayHit>& hit, const LightRule& rule,
                SampleReceiver kind) const;

    const RayOracle& oracle_;
    const Frame& frame_;
    const Light& light_;
    const LightSample& position_;
};

/// One place in each cell of a grid over the pixel, from its centre, in pixels: across * across, rows from the bottom.
/// At random, but the same for the same seed.
std::vector<glm::dvec2> make_jittered_offsets(int across, std::uint32_t seed);

}  // namespace shadow_layers::truth
