// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/pixel_means.h"

#include <algorithm>
#include <numeric>

#include "base/thread_pool.h"
#include "frame/camera_window.h"
#include "truth/pixel_samples.h"
#include "truth/plane_shadow.h"

namespace shadow_layers::truth {
namespace {

constexpr int kBandRows = 32;           // of pixels whose probes are held at once
constexpr std::size_t kBlock = 1 << 8;  // pixels

/// Visibility at the corners, sides' middles and centres of the pixels of some rows.
class Probes {
public:
    Probes(const RayOracle& oracle, const Frame& frame, int row, int rows, const Light& light,
           const LightSample& position, ThreadPool& threads)
        : columns_(2 * frame.width + 1) {
        // Half a pixel wide each, and the first of them about the band's lower left corner.
        const Camera camera = crop_camera(frame.camera, 2 * frame.width, 2 * frame.height,
                                          {0, 2 * row, columns_, 2 * rows + 1}, 0, glm::dvec2(-0.5));
        const Frame band = oracle.make_frame(camera, columns_, 2 * rows + 1, &threads);
        visibility_ = oracle.compute_visibility(band, light, position, &threads);
    }
    /// The value that all nine of a pixel have, else -1. `y` from the band's first row.
    float find_common(int x, int y) const {
        const float first = at(2 * x, 2 * y);
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
                if (at(2 * x + i, 2 * y + j) != first) return -1;
        return first;
    }

private:
    float at(int column, int row) const {
        return visibility_[std::size_t(row) * std::size_t(columns_) + std::size_t(column)];
    }
    int columns_;
    std::vector<float> visibility_;
};

float take_mean(const PixelSamples& samples, std::size_t pixel) {
    const auto offsets = make_jittered_offsets(kSamplesAcross, std::uint32_t(pixel));
    const auto visible = samples.find_visibility(pixel, offsets, SampleReceiver::OwnRay);
    return float(std::accumulate(visible.begin(), visible.end(), 0)) / float(visible.size());
}

}  // namespace

std::vector<float> compute_pixel_means(const RayOracle& oracle, const TriangleTree& tree, const Frame& frame,
                                       const Light& light, const LightSample& position, ThreadPool& threads,
                                       const std::function<void()>& check_cancelled) {
    const PixelSamples samples(oracle, frame, light, position);
    const PlaneShadows planes(oracle, tree, frame, light, position);
    const auto width = std::size_t(frame.width);
    std::vector<float> means(frame.pixel_count());
    for (int row = 0; row < frame.height; row += kBandRows) {
        const int rows = std::min(kBandRows, frame.height - row);
        const Probes probes(oracle, frame, row, rows, light, position, threads);
        threads.parallel_for(width * std::size_t(rows), kBlock, [&](std::size_t begin, std::size_t end) {
            check_cancelled();
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t pixel = std::size_t(row) * width + i;
                if (planes.sees_plane_alone(pixel)) {
                    if (const auto part = planes.find_lit_part(pixel)) {
                        means[pixel] = float(*part);
                        continue;
                    }
                }
                means[pixel] = probes.find_common(int(i % width), int(i / width));
                if (means[pixel] < 0) means[pixel] = take_mean(samples, pixel);
            }
        });
    }
    return means;
}

}  // namespace shadow_layers::truth
