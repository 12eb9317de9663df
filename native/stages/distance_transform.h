// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "engine/engine.h"
#include "nearest_site.h"

namespace shadow_layers {

/// Exact Euclidean distance transform with the nearest site itself.
///
/// In: a mask, not 0 where a pixel is a site. Out, per pixel: y << 16 | x of the site whose centre is nearest, kNoSite
/// where there is none. Of sites at the same distance it is the one with the smallest packed value (lowest row, then
/// leftmost), so that the result is one picture, bit for bit, whatever made it. All arithmetic is in integers.
/// shaders/lib/nearest_site_lib.glsl reads the picture.
struct DistanceTransformOptions {
    /// Largest distance that matters, in pixels between centres, at least 0. Pixels whose nearest site is farther get
    /// kNoSite; the less it is, the less work.
    int bound_px = std::numeric_limits<int>::max();
};

/// InputError, naming sides or bound, unless a transform of that size can be made.
void check_transform(int width, int height, const DistanceTransformOptions& options);

/// On the CPU. `mask` and `nearest` hold width * height pixels, row 0 first. InputError for a side outside
/// [1, kLargestTransformSide], spans of another size, or a negative bound.
void find_nearest_sites(std::span<const std::uint8_t> mask, int width, int height,
                        const DistanceTransformOptions& options, ThreadPool& threads, std::span<std::uint32_t> nearest);

/// From texture to texture, by compute shaders or by find_nearest_sites, whichever the renderer in use does faster:
/// both are timed on a picture of border lines when the first transform runs. The result is the same. Kept by a
/// technique between frames.
class DistanceTransform {
public:
    enum class Method : std::uint8_t { CPU, GL };

    /// `mask_tx`: GL_R8UI or GL_R8, any rectangle. The result is GL_R32UI of the same size, valid until the next run.
    /// Stage "distance_transform". InputError for a mask of another format, else as check_transform.
    const gl::Texture& run(Engine& engine, const gl::Texture& mask_tx, const DistanceTransformOptions& options = {});

    /// The same by a given method; for tests and the benchmark.
    const gl::Texture& run_by(Engine& engine, Method method, const gl::Texture& mask_tx,
                              const DistanceTransformOptions& options = {});

    /// Of the last result and of what led to it, on the GL and beside it.
    std::size_t byte_size() const;

    /// Which method run() takes; measured at the first call (stage "distance_transform_choice").
    Method fastest_method(Engine& engine);

private:
    void transform(Engine& engine, Method method, const gl::Texture& mask_tx, const DistanceTransformOptions& options);
    void transform_on_cpu(Engine& engine, const gl::Texture& mask_tx, const DistanceTransformOptions& options);
    void transform_on_gl(Engine& engine, const gl::Texture& mask_tx, int bound_px);
    void find_column_sites(Engine& engine, const gl::Texture& mask_tx, int band_rows, int band_count, int bound_px);
    double time_method(Engine& engine, Method method, const gl::Texture& mask_tx);

    std::optional<Method> fastest_;
    gl::Texture nearest_tx_;
    gl::Texture sites_tx_, links_tx_;  ///< of the GL method, transposed
    gl::Buffer margin_buf_, ends_buf_;
    std::vector<std::uint8_t> mask_;      ///< of the CPU method
    std::vector<std::uint32_t> nearest_;  ///< likewise
};

}  // namespace shadow_layers
