// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "shadow_layers/camera.h"
#include "shadow_layers/request.h"
#include "shadow_layers/scene.h"
#include "shadow_layers/technique_descriptor.h"
#include "truth/soft_shadow.h"

namespace shadow_layers::truth {

/// The soft shadow of a light's own shape, per pixel, with its standard error.
struct SoftTruth {
    std::vector<float> mean, standard_error;
};

/// What the layers of one picture should be, by exact rays: one sample at each pixel's centre (but for the truth that
/// is a mean over the pixel), row 0 at the bottom.
class ExactLayers {
public:
    /// Finds what each pixel sees. `threads` <= 0: one per core. Throws Cancelled, as `compute`, once `cancelled` is
    /// true, which may be set by any thread and must outlive this.
    ExactLayers(std::shared_ptr<const Scene> scene, const Camera& camera, int width, int height, int threads,
                const std::atomic<bool>& cancelled);
    ~ExactLayers();
    ExactLayers(const ExactLayers&) = delete;
    ExactLayers& operator=(const ExactLayers&) = delete;

    /// The truth of a layer, 0 to 1 per pixel (width * height). `map_size`: of the technique's views, for footprints in
    /// texels.
    ///
    /// Hard: the mask of the light's centre. Filtered: its mean over a square of points in the plane of the receiver's
    /// triangle; the square is taken in the map's plane (footprint_texels) or in the receiver's (footprint_world);
    /// the receiver's own surface, where it rises before that plane less than it is away, is no blocker. Where the
    /// square's corners, sides' middles and centre agree, they are the answer; elsewhere kFilterSide^2 points are
    /// taken. Soft: that of the light's own shape (ShapeShadows). Pixel: the mean over the pixel's square
    /// (compute_pixel_means). Throws Cancelled.
    std::vector<float> compute(std::uint32_t light, const TruthSpec& spec, int map_size) const;

    /// The truth of kind Soft, with its standard error.
    SoftTruth compute_soft(std::uint32_t light) const;

    /// The truth of a layer that takes exactly these samples of the light's shape: what differs from it is wrong,
    /// whatever the number of samples. `ids`: the triangles that the layer's own frame sees (FrameResult::ids).
    /// Throws Cancelled.
    std::vector<LitPart> compute_at_samples(std::uint32_t light, int light_samples, LightPattern pattern,
                                            const IdImage& ids) const;

    /// 1 where the pixel's visibility is decided by what lies between it and the light: its face is turned to the
    /// light, inside its cone, and linked.
    std::vector<std::uint8_t> find_comparable(std::uint32_t light) const;

    static constexpr int kFilterSide = 8;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace shadow_layers::truth
