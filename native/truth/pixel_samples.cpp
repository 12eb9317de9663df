// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/pixel_samples.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "base/thread_pool.h"
#include "frame/camera_window.h"
#include "lights/facing.h"
#include "lights/sample_pattern.h"

namespace shadow_layers::truth {
namespace {

constexpr int kBandRows = 32;           // of pixels whose probes are held at once
constexpr std::size_t kBlock = 1 << 8;  // pixels

/// Visibility at the corners, sides' middles and centres of the pixels of some rows.
class Probes {
public:
    Probes(const RayOracle& oracle, const Camera& camera, int width, int height, int row, int rows, const Light& light,
           const LightPosition& position, ThreadPool& threads)
        : columns_(2 * width + 1) {
        // Half a pixel wide each, and the first of them about the band's lower left corner.
        const Camera band =
            crop_camera(camera, 2 * width, 2 * height, {0, 2 * row, columns_, 2 * rows + 1}, 0, glm::dvec2(-0.5));
        const Frame frame = oracle.make_frame(band, columns_, 2 * rows + 1, &threads);
        visibility_ = oracle.compute_visibility(frame, light, position, &threads);
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

/// A frame whose pixels are places in one pixel, for the one rule of what faces the light.
struct ReceiverList {
    ReceiverList(const Frame& empty, std::size_t count) : frame(empty), points_ws(count) {
        frame.width = int(count), frame.height = 1;
        frame.positions_rel.assign(count, glm::vec3(0));
        frame.normals.assign(count, glm::vec3(0));
        frame.ids.assign(count, {});
        frame.coverage.assign(count, 0);
    }
    void set(std::size_t k, const RayOracle& oracle, const PixelRay& ray, const std::optional<RayHit>& hit) {
        if (!hit) return;
        points_ws[k] = ray.origin_ws + hit->distance * ray.direction;
        oracle.set_receiver(frame, k, ray, *hit);
    }
    Frame frame;
    std::vector<glm::dvec3> points_ws;
};

}  // namespace

PixelSamples::PixelSamples(const RayOracle& oracle, std::shared_ptr<const Scene> scene, const Camera& camera, int width,
                           int height, const Light& light, const LightPosition& position)
    : oracle_(oracle), width_(width), height_(height), light_(light), position_(position) {
    empty_.camera = camera;
    empty_.scene = std::move(scene);
    empty_.origin_ws = glm::dvec3(camera.world_from_camera[3]);
}

std::optional<RayHit> PixelSamples::see(const PixelRay& ray) const {
    const Camera& camera = empty_.camera;
    auto hit = oracle_.find_first(ray.origin_ws, ray.direction, camera.clip_start, camera.clip_end, kInstanceCamera);
    // As the layers' receivers: on the triangle's plane, whatever edge let the ray in.
    if (hit) hit->distance = oracle_.meet_plane(ray, hit->ids).value_or(hit->distance);
    return hit;
}

std::optional<RayHit> PixelSamples::meet_facet(const PixelRay& ray, const PixelIds& ids) const {
    const auto distance = oracle_.meet_plane(ray, ids);
    if (!distance || (empty_.camera.perspective && *distance <= 0)) return std::nullopt;
    return RayHit{ids, *distance};
}

std::vector<std::uint8_t> PixelSamples::find_visibility(int x, int y, std::span<const glm::dvec2> offsets_px,
                                                        SampleReceiver receiver) const {
    const auto make_ray = [&](const glm::dvec2& offset) {
        return compute_pixel_ray(empty_.camera, x + 0.5 + offset.x, y + 0.5 + offset.y, width_, height_);
    };
    const auto centre = receiver == SampleReceiver::CentreFacet ? see(make_ray(glm::dvec2(0))) : std::nullopt;
    ReceiverList receivers(empty_, offsets_px.size());
    for (std::size_t k = 0; k < offsets_px.size(); ++k) {
        const PixelRay ray = make_ray(offsets_px[k]);
        if (receiver == SampleReceiver::OwnRay)
            receivers.set(k, oracle_, ray, see(ray));
        else if (centre)
            receivers.set(k, oracle_, ray, meet_facet(ray, centre->ids));
    }
    const FacingRule rule(receivers.frame, light_, position_);
    std::vector<std::uint8_t> visible(offsets_px.size());
    for (std::size_t k = 0; k < offsets_px.size(); ++k) {
        const Facing facing = rule.classify(k);
        visible[k] = get_unoccluded_visibility(facing) > 0;
        if (facing == Facing::Lit && light_.casts_shadow)
            visible[k] = !oracle_.is_occluded(receivers.points_ws[k], receivers.frame.ids[k], light_, position_);
    }
    return visible;
}

std::vector<glm::dvec2> make_jittered_offsets(int across, std::uint32_t seed) {
    const SamplePattern random(LightPattern::Random, across * across);
    std::vector<glm::dvec2> offsets;
    for (int y = 0; y < across; ++y) {
        for (int x = 0; x < across; ++x) {
            // Runs of the one endless sequence of random points, a prime number apart from pixel to pixel.
            const int number = int((std::uint64_t(seed) * 8191 + offsets.size()) % (1u << 30));
            offsets.push_back((glm::dvec2(x, y) + random.get_in_square(number)) / double(across) - 0.5);
        }
    }
    return offsets;
}

std::vector<float> compute_pixel_means(const RayOracle& oracle, const std::shared_ptr<const Scene>& scene,
                                       const Camera& camera, int width, int height, const Light& light,
                                       const LightPosition& position, ThreadPool& threads,
                                       const std::function<void()>& check_cancelled) {
    const PixelSamples samples(oracle, scene, camera, width, height, light, position);
    std::vector<float> means(std::size_t(width) * std::size_t(height));
    for (int row = 0; row < height; row += kBandRows) {
        const int rows = std::min(kBandRows, height - row);
        const Probes probes(oracle, camera, width, height, row, rows, light, position, threads);
        threads.parallel_for(std::size_t(width) * std::size_t(rows), kBlock, [&](std::size_t begin, std::size_t end) {
            check_cancelled();
            for (std::size_t i = begin; i < end; ++i) {
                const int x = int(i % std::size_t(width)), y = int(i / std::size_t(width));
                const std::size_t pixel = std::size_t(row) * std::size_t(width) + i;
                means[pixel] = probes.find_common(x, y);
                if (means[pixel] >= 0) continue;
                const auto offsets = make_jittered_offsets(kSamplesAcross, std::uint32_t(pixel));
                const auto visible = samples.find_visibility(x, row + y, offsets, SampleReceiver::OwnRay);
                means[pixel] = float(std::accumulate(visible.begin(), visible.end(), 0)) / float(visible.size());
            }
        });
    }
    return means;
}

}  // namespace shadow_layers::truth
