// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// RayOracle over the pixels of a frame: what they see, and the shadow there.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/thread_pool.h"
#include "truth/ray_oracle.h"

namespace shadow_layers::truth {
namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon();
// A pixel's centre may lie a little outside of the triangle that the raster gave it, and so may its depth.
constexpr double kDepthSlack = 0.05;

template <class Work>
void for_pixels(std::size_t count, ThreadPool* threads, const Work& work) {
    const auto range = [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel) work(pixel);
    };
    if (threads)
        threads->parallel_for(count, 1 << 12, range);
    else
        range(0, count);
}

glm::dvec3 find_normal(const Corners& corners, const glm::dvec3& view) {
    const glm::dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    return glm::dot(normal, view) > 0 ? -normal : normal;
}

}  // namespace

Receiver RayOracle::make_receiver(const PixelRay& ray, const RayHit& hit) const {
    Receiver receiver;
    receiver.ids = hit.ids;
    receiver.place_ws = ray.origin_ws + hit.distance * ray.direction;
    receiver.normal = find_normal(get_corners(hit.ids), ray.direction);
    receiver.camera_distance = std::abs(hit.distance) * glm::length(ray.direction);
    const double steepness = std::abs(glm::dot(receiver.normal, glm::normalize(ray.direction)));
    const double size = glm::length(receiver.place_ws) + glm::length(ray.origin_ws) + glm::length(get_origin());
    receiver.slack = 8 * kRounding * size / std::max(steepness, 1e-9);
    return receiver;
}

std::optional<Receiver> RayOracle::find_receiver(const Frame& frame, std::size_t pixel) const {
    if (!frame.coverage[pixel] || frame.ids[pixel].instance == kNoId) return std::nullopt;
    const PixelRay ray = compute_centre_ray(frame, pixel);
    const glm::dvec3 ahead = -glm::dvec3(frame.camera.world_from_camera[2]);
    double near = std::numeric_limits<double>::infinity(), far = -near;
    for (const glm::dvec3& corner : get_corners(frame.ids[pixel])) {
        const double depth = glm::dot(corner + (get_origin() - ray.origin_ws), ahead);
        near = std::min(near, depth), far = std::max(far, depth);
    }
    const double slack = kDepthSlack * (far - near) + 8 * kRounding * std::abs(far);
    const double met = meet_plane(ray, frame.ids[pixel]).value_or(std::numeric_limits<double>::quiet_NaN());
    const double held = std::clamp(std::isnan(met) ? near : met, near - slack, far + slack);
    Receiver receiver = make_receiver(ray, {frame.ids[pixel], held});
    receiver.certain = met == held;
    return receiver;
}

Visibility RayOracle::find_visibility(const Receiver& receiver, const LightRule& rule, const Light& light,
                                      const LightSample& sample) const {
    const Standings standings = rule.find_standings(receiver);
    Visibility found;
    found.least = standings.may_be_turned_away ? 0 : 1;
    found.most = standings.may_be_apart ? 1 : 0;
    bool blocked = false;
    if (standings.may_be_facing) {
        const Sight sight = light.casts_shadow ? look(receiver, light, sample) : Sight{};
        blocked = sight.blocked;
        if (sight.blocked || !sight.certain) found.least = 0;
        if (!sight.blocked || !sight.certain) found.most = 1;
    }
    if (!receiver.certain) found.least = 0, found.most = 1;
    found.decided = standings.decided == Standing::Apart                   ? 1
                    : standings.decided == Standing::TurnedAway || blocked ? 0
                                                                           : 1;
    return found;
}

std::vector<Visibility> RayOracle::compute_visibility_ranges(const Frame& frame, const Light& light,
                                                             const LightSample& sample, ThreadPool* threads) const {
    const LightRule rule(*frame.scene, light, sample);
    std::vector<Visibility> visibility(frame.pixel_count());
    for_pixels(visibility.size(), threads, [&](std::size_t pixel) {
        if (const auto receiver = find_receiver(frame, pixel))
            visibility[pixel] = find_visibility(*receiver, rule, light, sample);
    });
    return visibility;
}

std::vector<float> RayOracle::compute_visibility(const Frame& frame, const Light& light, const LightSample& sample,
                                                 ThreadPool* threads) const {
    std::vector<float> decided;
    decided.reserve(frame.pixel_count());
    for (const Visibility& visibility : compute_visibility_ranges(frame, light, sample, threads))
        decided.push_back(visibility.decided);
    return decided;
}

Frame RayOracle::make_frame(const Camera& camera, int width, int height, ThreadPool* threads) const {
    Frame frame;
    frame.width = width, frame.height = height;
    frame.region = {0, 0, width, height};
    frame.camera = camera;
    frame.origin_ws = glm::dvec3(camera.world_from_camera[3]);
    frame.scene = get_scene();
    frame.positions_rel.assign(frame.pixel_count(), glm::vec3(0));
    frame.normals.assign(frame.pixel_count(), glm::vec3(0));
    frame.ids.assign(frame.pixel_count(), {});
    frame.coverage.assign(frame.pixel_count(), 0);
    for_pixels(frame.pixel_count(), threads, [&](std::size_t pixel) {
        const PixelRay ray = compute_centre_ray(frame, pixel);
        const auto hit = find_first(ray.origin_ws, ray.direction, camera.clip_start, camera.clip_end, kInstanceCamera);
        if (!hit) return;
        frame.ids[pixel] = hit->ids;
        frame.coverage[pixel] = !(frame.scene->instances[hit->ids.instance].flags & kInstanceHoldout);
        frame.positions_rel[pixel] = glm::vec3(ray.origin_ws + hit->distance * ray.direction - frame.origin_ws);
        frame.normals[pixel] = glm::vec3(find_normal(get_corners(hit->ids), ray.direction));
    });
    return frame;
}

PixelRay compute_pixel_ray(const Camera& camera, double x_px, double y_px, int width, int height) {
    const CameraWindow& window = camera.window;
    const double x = window.left + (window.right - window.left) * x_px / width;
    const double y = window.bottom + (window.top - window.bottom) * y_px / height;
    const glm::dmat3 axes(camera.world_from_camera);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    if (camera.perspective) return {eye, axes * glm::dvec3(x, y, -1)};
    return {eye + axes * glm::dvec3(x, y, 0), axes * glm::dvec3(0, 0, -1)};
}

PixelRay compute_centre_ray(const Frame& frame, std::size_t pixel) {
    const auto width = std::size_t(frame.width);
    return compute_pixel_ray(frame.camera, double(pixel % width) + 0.5, double(pixel / width) + 0.5, frame.width,
                             frame.height);
}

}  // namespace shadow_layers::truth
