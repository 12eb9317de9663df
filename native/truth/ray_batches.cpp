// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/ray_batches.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/thread_pool.h"
#include "truth/light_rule.h"

namespace shadow_layers::truth {
namespace {

constexpr unsigned kPacket = 16;
constexpr std::size_t kStream = 512;  // rays: they stay in the first cache
constexpr std::size_t kBatchesPerBlock = 4;
constexpr int kPixelBlock = 4;
constexpr std::size_t kBandsPerBlock = 4;
// Rays leave their receivers by this part of the scene's size: Embree knows nothing of the receiver's own triangle.
constexpr double kLeave = 1e-5;

float find_cone_cos(const Light& light) {
    if (light.kind == LightKind::Spot) return float(std::cos(0.5 * light.spot_angle));
    return light.kind == LightKind::Area ? 0.0f : -1.0f;
}

}  // namespace

RayList::RayList(const Frame& frame, const Light& light, std::span<const LightSample> samples, double reach,
                 ThreadPool& threads)
    : light_(light),
      backward_(glm::normalize(glm::dvec3(light.world_from_light[2]))),
      cone_cos_(find_cone_cos(light)),
      leave_(float(kLeave * reach)) {
    for (const LightSample& sample : samples)
        targets_.push_back({sample.directional,
                            glm::vec3(sample.directional ? sample.to_light_ws : sample.position_ws - frame.origin_ws)});
    const std::size_t count = std::size_t((frame.height + kPixelBlock - 1) / kPixelBlock);
    std::vector<std::vector<Receiver>> bands(count);
    threads.parallel_for(count, kBandsPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t band = begin; band < end; ++band) list_band(frame, int(band) * kPixelBlock, bands[band]);
    });
    std::vector<std::size_t> first(count + 1, 0);
    for (std::size_t band = 0; band < count; ++band) first[band + 1] = first[band] + bands[band].size();
    receivers_.resize(first.back());
    threads.parallel_for(count, kBandsPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t band = begin; band < end; ++band)
            std::copy(bands[band].begin(), bands[band].end(), receivers_.begin() + std::ptrdiff_t(first[band]));
    });
}

bool RayList::is_linked(const Frame& frame, std::size_t pixel) const {
    return frame.coverage[pixel] && frame.ids[pixel].instance != kNoId &&
           (light_.receiver_set >> frame.scene->instances[frame.ids[pixel].instance].receiver_group & 1u);
}

bool RayList::is_in_cone(const glm::vec3& to_light) const {
    return glm::dot(backward_, to_light) >= cone_cos_ * glm::length(to_light);
}

bool RayList::faces(const Receiver& receiver, const Target& target, glm::vec3& to_light) const {
    to_light = target.directional ? target.place : target.place - receiver.place;
    return glm::dot(receiver.normal, to_light) > 0 &&
           (cone_cos_ <= -1 || is_in_cone(glm::vec3(undo_spot_scale(light_, to_light))));
}

void RayList::list_band(const Frame& frame, int top, std::vector<Receiver>& band) const {
    band.reserve(std::size_t(kPixelBlock) * std::size_t(frame.width));
    for (int left = 0; left < frame.width; left += kPixelBlock)
        for (int y = top; y < std::min(top + kPixelBlock, frame.height); ++y)
            for (int x = left; x < std::min(left + kPixelBlock, frame.width); ++x) {
                const std::size_t pixel = std::size_t(y) * std::size_t(frame.width) + std::size_t(x);
                if (!is_linked(frame, pixel)) continue;
                const Receiver receiver{frame.positions_rel[pixel], frame.normals[pixel], std::uint32_t(pixel)};
                glm::vec3 to_light;
                const auto faced = [&](const Target& target) { return faces(receiver, target, to_light); };
                if (std::any_of(targets_.begin(), targets_.end(), faced)) band.push_back(receiver);
            }
}

std::optional<RTCRay> RayList::make_ray(std::size_t index) const {
    const Receiver& receiver = receivers_[index / targets_.size()];
    const Target& target = targets_[index % targets_.size()];
    glm::vec3 to_light;
    if (!faces(receiver, target, to_light)) return std::nullopt;
    RTCRay ray{};
    ray.org_x = receiver.place.x, ray.org_y = receiver.place.y, ray.org_z = receiver.place.z;
    ray.dir_x = to_light.x, ray.dir_y = to_light.y, ray.dir_z = to_light.z;
    ray.tnear = target.directional ? leave_ : leave_ / glm::length(to_light);
    ray.tfar = target.directional ? std::numeric_limits<float>::infinity() : 1.0f;
    ray.mask = ~0u;
    ray.id = receiver.pixel;
    return ray;
}

/// Calls trace(begin, end) for ranges of rays, each with whole receivers, so that a pixel is one thread's.
template <class Trace>
std::size_t RayList::trace_batches(ThreadPool& threads, const Trace& trace) const {
    const std::size_t samples = targets_.size(), receivers = std::max<std::size_t>(1, kStream / samples);
    const std::size_t batches = (receivers_.size() + receivers - 1) / receivers;
    std::atomic<std::size_t> rays{0};
    threads.parallel_for(batches, kBatchesPerBlock, [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t batch = begin; batch < end; ++batch)
            count += trace(batch * receivers * samples, std::min((batch + 1) * receivers, receivers_.size()) * samples);
        rays += count;
    });
    return rays;
}

std::size_t RayList::trace_packets(RTCScene scene, ThreadPool& threads, std::vector<std::uint16_t>& lit) const {
    return trace_batches(threads, [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t first = begin; first < end; first += kPacket) {
            alignas(64) RTCRay16 rays;
            alignas(64) int valid[kPacket];
            for (unsigned lane = 0; lane < kPacket; ++lane) {
                const auto ray = first + lane < end ? make_ray(first + lane) : std::nullopt;
                valid[lane] = ray ? -1 : 0;
                if (!ray) continue;
                rays.org_x[lane] = ray->org_x, rays.org_y[lane] = ray->org_y, rays.org_z[lane] = ray->org_z;
                rays.dir_x[lane] = ray->dir_x, rays.dir_y[lane] = ray->dir_y, rays.dir_z[lane] = ray->dir_z;
                rays.tnear[lane] = ray->tnear, rays.tfar[lane] = ray->tfar;
                rays.time[lane] = 0, rays.mask[lane] = ray->mask, rays.id[lane] = ray->id;
                ++count;
            }
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
            rtcOccluded16(valid, scene, &context, &rays);
            for (unsigned lane = 0; lane < kPacket; ++lane)
                if (valid[lane] && rays.tfar[lane] >= 0) ++lit[rays.id[lane]];
        }
        return count;
    });
}

std::size_t RayList::trace_stream(RTCScene scene, ThreadPool& threads, std::vector<std::uint16_t>& lit) const {
    return trace_batches(threads, [&](std::size_t begin, std::size_t end) {
        std::vector<RTCRay> rays;
        rays.reserve(end - begin);
        for (std::size_t index = begin; index < end; ++index)
            if (const auto ray = make_ray(index)) rays.push_back(*ray);
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        rtcOccluded1M(scene, &context, rays.data(), unsigned(rays.size()), sizeof(RTCRay));
        for (const RTCRay& ray : rays)
            if (ray.tfar >= 0) ++lit[ray.id];
        return rays.size();
    });
}

}  // namespace shadow_layers::truth
