// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/pixel_samples.h"

#include "lights/facing.h"
#include "lights/sample_pattern.h"

namespace shadow_layers::truth {
namespace {

/// A frame whose pixels are places in one pixel, for the one rule of what faces the light.
struct ReceiverList {
    ReceiverList(const Frame& seen, std::size_t count) : points_ws(count) {
        frame.width = int(count), frame.height = 1;
        frame.origin_ws = seen.origin_ws;
        frame.scene = seen.scene;
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

PixelSamples::PixelSamples(const RayOracle& oracle, const Frame& frame, const Light& light, const LightSample& position)
    : oracle_(oracle), frame_(frame), light_(light), position_(position) {}

std::optional<RayHit> PixelSamples::see(const PixelRay& ray) const {
    const Camera& camera = frame_.camera;
    auto hit = oracle_.find_first(ray.origin_ws, ray.direction, camera.clip_start, camera.clip_end, kInstanceCamera);
    // As the layers' receivers: on the triangle's plane, whatever edge let the ray in.
    if (hit) hit->distance = oracle_.meet_plane(ray, hit->ids).value_or(hit->distance);
    return hit;
}

std::optional<RayHit> PixelSamples::meet_facet(const PixelRay& ray, const PixelIds& ids) const {
    const auto distance = oracle_.meet_plane(ray, ids);
    if (!distance || (frame_.camera.perspective && *distance <= 0)) return std::nullopt;
    return RayHit{ids, *distance};
}

std::vector<std::uint8_t> PixelSamples::find_visibility(std::size_t pixel, std::span<const glm::dvec2> offsets_px,
                                                        SampleReceiver receiver) const {
    const auto width = std::size_t(frame_.width);
    const glm::dvec2 centre(double(pixel % width) + 0.5, double(pixel / width) + 0.5);
    const PixelIds ids = frame_.ids[pixel];
    ReceiverList receivers(frame_, offsets_px.size());
    for (std::size_t k = 0; k < offsets_px.size(); ++k) {
        const glm::dvec2 place = centre + offsets_px[k];
        const PixelRay ray = compute_pixel_ray(frame_.camera, place.x, place.y, frame_.width, frame_.height);
        if (receiver == SampleReceiver::OwnRay)
            receivers.set(k, oracle_, ray, see(ray));
        else if (ids.instance != kNoId)
            receivers.set(k, oracle_, ray, meet_facet(ray, ids));
    }
    const FacingRule rule(receivers.frame, light_, position_);
    const OwnSurface own = receiver == SampleReceiver::OwnRay ? OwnSurface::Neighbours : OwnSurface::WholePlane;
    std::vector<std::uint8_t> visible(offsets_px.size());
    for (std::size_t k = 0; k < offsets_px.size(); ++k) {
        const Facing facing = rule.classify(k);
        visible[k] = get_unoccluded_visibility(facing) > 0;
        if (facing == Facing::Lit && light_.casts_shadow)
            visible[k] = !oracle_.is_occluded(receivers.points_ws[k], receivers.frame.ids[k], light_, position_, own);
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

}  // namespace shadow_layers::truth
