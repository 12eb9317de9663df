// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
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

/// Exact hard visibility at any place in any pixel of a picture, for one position of a light.
class PixelSamples {
public:
    /// All must outlive this, but for the camera.
    PixelSamples(const RayOracle& oracle, std::shared_ptr<const Scene> scene, const Camera& camera, int width,
                 int height, const Light& light, const LightPosition& position);

    /// For each offset (dx, dy), in pixels from the centre of the pixel in column x and row y (0 at the bottom): 1 =
    /// lit, 0 = in shadow or turned away. Each place goes by the rule of lights/facing.h for itself: 1 in the
    /// background, outside the cone and unlinked. With CentreFacet all places of a pixel that sees background are
    /// background, and a ray that misses the plane is lit. May be called by many threads.
    std::vector<std::uint8_t> find_visibility(int x, int y, std::span<const glm::dvec2> offsets_px,
                                              SampleReceiver receiver) const;

private:
    /// What the camera sees along the ray.
    std::optional<RayHit> see(const PixelRay& ray) const;
    /// Where the ray meets the plane of the triangle before the camera.
    std::optional<RayHit> meet_facet(const PixelRay& ray, const PixelIds& ids) const;

    const RayOracle& oracle_;
    Frame empty_;  ///< of the picture's camera, without pixels
    int width_, height_;
    const Light& light_;
    const LightPosition& position_;
};

/// The hard mask averaged over each pixel's square, 0 to 1 (width * height, row 0 at the bottom): the plain mean over
/// places that each count what they see by themselves, background as 1 and faces turned away as 0, which is what a hard
/// technique's layer tends to with ever more samples per pixel of a box filter. Where the pixel's corners, sides'
/// middles and centre agree they are the answer; elsewhere kSamplesAcross^2 places are taken, one at a random place of
/// each cell of a grid, the same ones every time. `check_cancelled` is called now and then by any thread, and may
/// throw.
std::vector<float> compute_pixel_means(const RayOracle& oracle, const std::shared_ptr<const Scene>& scene,
                                       const Camera& camera, int width, int height, const Light& light,
                                       const LightPosition& position, ThreadPool& threads,
                                       const std::function<void()>& check_cancelled);

inline constexpr int kSamplesAcross = 16;

/// One place in each cell of a grid over the pixel, from its centre, in pixels: across * across, rows from the bottom.
std::vector<glm::dvec2> make_jittered_offsets(int across, std::uint32_t seed);

}  // namespace shadow_layers::truth
