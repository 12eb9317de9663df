// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/pixel_samples.h"

#include "lights/sample_pattern.h"

namespace shadow_layers::truth {

PixelSamples::PixelSamples(const RayOracle& oracle, const Frame& frame, const Light& light, const LightSample& position)
    : oracle_(oracle), frame_(frame), light_(light), position_(position) {}

std::optional<RayHit> PixelSamples::see(const PixelRay& ray) const {
    const Camera& camera = frame_.camera;
    auto hit = oracle_.find_first(ray.origin_ws, ray.direction, camera.clip_start, camera.clip_end, kInstanceCamera);
    // As the layers' receivers: on the triangle's plane, whatever edge let the ray in.
    if (hit) hit->distance = oracle_.meet_plane(ray, hit->ids).value_or(hit->distance);
    return hit;
}

std::optional<RayHit> PixelSamples::meet_facet(const PixelRay& ray, std::size_t pixel) const {
    const PixelIds ids = frame_.ids[pixel];
    if (ids.instance == kNoId) return std::nullopt;
    const auto distance = oracle_.meet_plane(ray, ids);
    if (!distance || (frame_.camera.perspective && *distance <= 0)) return std::nullopt;
    return RayHit{ids, *distance};
}

bool PixelSamples::is_lit(const PixelRay& ray, const std::optional<RayHit>& hit, const LightRule& rule,
                          SampleReceiver kind) const {
    if (!hit || frame_.scene->instances[hit->ids.instance].flags & kInstanceHoldout) return true;
    const Receiver receiver = oracle_.make_receiver(ray, *hit);
    const Standing standing = rule.find_standing(receiver);
    if (standing != Standing::Facing || !light_.casts_shadow) return standing != Standing::TurnedAway;
    const OwnSurface own = kind == SampleReceiver::OwnRay ? OwnSurface::Neighbours : OwnSurface::WholePlane;
    return !oracle_.look(receiver, light_, position_, own).blocked;
}

std::vector<std::uint8_t> PixelSamples::find_visibility(std::size_t pixel, std::span<const glm::dvec2> offsets_px,
                                                        SampleReceiver receiver) const {
    const auto width = std::size_t(frame_.width);
    const glm::dvec2 centre(double(pixel % width) + 0.5, double(pixel / width) + 0.5);
    const LightRule rule(*frame_.scene, light_, position_);
    std::vector<std::uint8_t> visible;
    for (const glm::dvec2& offset : offsets_px) {
        const glm::dvec2 place = centre + offset;
        const PixelRay ray = compute_pixel_ray(frame_.camera, place.x, place.y, frame_.width, frame_.height);
        visible.push_back(
            is_lit(ray, receiver == SampleReceiver::OwnRay ? see(ray) : meet_facet(ray, pixel), rule, receiver));
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
