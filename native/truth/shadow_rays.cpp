// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/shadow_rays.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/clock.h"
#include "base/thread_pool.h"
#include "frame/frame.h"
#include "lights/facing.h"
#include "lights/light_shape.h"
#include "lights/light_views.h"
#include "scene/bounds.h"
#include "truth/embree_scene.h"

namespace shadow_layers::truth {
namespace {

constexpr unsigned kPacket = 16;
constexpr std::size_t kPacketsPerBlock = 64;
constexpr int kPixelBlock = 4;
constexpr std::size_t kBandsPerBlock = 4;
// Rays leave their receivers by this part of the scene's size: Embree knows nothing of the receiver's own triangle.
constexpr double kLeave = 1e-5;

constexpr ShadowRayMode kModes[] = {{"low quality", false, false},
                                    {"medium quality", true, false},
                                    {"low quality, instances", false, true},
                                    {"medium quality, instances", true, true}};

/// A receiver of the picture, relative to the camera, and the way to the light.
struct Receiver {
    glm::vec3 origin, to_light;
    std::uint32_t pixel;
};

/// The frame as far as FacingRule asks for it.
Frame make_frame(const RenderRequest& request, const FrameResult& result) {
    Frame frame;
    frame.width = result.coverage.width, frame.height = result.coverage.height;
    frame.scene = request.scene;
    frame.origin_ws = result.camera_position;
    const Image &positions = result.aux.at("position"), &normals = result.aux.at("normal"), &ids = result.aux.at("ids");
    for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
        const float *p = &positions.data[3 * pixel], *n = &normals.data[3 * pixel], *id = &ids.data[2 * pixel];
        frame.positions_rel.emplace_back(p[0], p[1], p[2]);
        frame.normals.emplace_back(n[0], n[1], n[2]);
        frame.ids.push_back(id[0] < 0 ? PixelIds{} : PixelIds{std::uint32_t(id[0]), std::uint32_t(id[1])});
        frame.coverage.push_back(result.coverage.data[pixel] > 0);
    }
    return frame;
}

/// Those whose visibility the casters decide, in blocks of pixels, so that a packet's rays lie close together.
class ReceiverList {
public:
    ReceiverList(const Frame& frame, const FacingRule& rule) : frame_(frame), rule_(rule) {}

    std::vector<Receiver> make(ThreadPool& threads) const {
        const std::size_t count = std::size_t((frame_.height + kPixelBlock - 1) / kPixelBlock);
        std::vector<std::vector<Receiver>> bands(count);
        threads.parallel_for(count, kBandsPerBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t band = begin; band < end; ++band) list_band(int(band) * kPixelBlock, bands[band]);
        });
        std::vector<std::size_t> first(count + 1, 0);
        for (std::size_t band = 0; band < count; ++band) first[band + 1] = first[band] + bands[band].size();
        std::vector<Receiver> all(first.back());
        threads.parallel_for(count, kBandsPerBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t band = begin; band < end; ++band)
                std::copy(bands[band].begin(), bands[band].end(), all.begin() + std::ptrdiff_t(first[band]));
        });
        return all;
    }

private:
    void list_band(int top, std::vector<Receiver>& band) const {
        band.reserve(std::size_t(kPixelBlock) * std::size_t(frame_.width));
        for (int left = 0; left < frame_.width; left += kPixelBlock)
            for (int y = top; y < std::min(top + kPixelBlock, frame_.height); ++y)
                for (int x = left; x < std::min(left + kPixelBlock, frame_.width); ++x) {
                    const std::size_t pixel = std::size_t(y) * std::size_t(frame_.width) + std::size_t(x);
                    if (rule_.classify(pixel) != Facing::Lit) continue;
                    band.push_back(
                        {frame_.positions_rel[pixel], glm::vec3(rule_.get_to_light(pixel)), std::uint32_t(pixel)});
                }
    }

    const Frame& frame_;
    const FacingRule& rule_;
};

/// All rays of the picture, 16 at a time.
class PacketTrace {
public:
    PacketTrace(RTCScene scene, std::span<const Receiver> receivers, bool directional, double reach,
                std::vector<std::uint8_t>& visible)
        : scene_(scene),
          receivers_(receivers),
          directional_(directional),
          leave_(float(kLeave * reach)),
          visible_(visible) {
        rtcInitIntersectContext(&context_);
        context_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }

    void run(ThreadPool& threads) {
        const std::size_t packets = (receivers_.size() + kPacket - 1) / kPacket;
        threads.parallel_for(packets, kPacketsPerBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t packet = begin; packet < end; ++packet) trace(packet * kPacket);
        });
    }

private:
    void trace(std::size_t first) {
        alignas(64) RTCRay16 rays;
        alignas(64) int valid[kPacket];
        const auto count = unsigned(std::min<std::size_t>(kPacket, receivers_.size() - first));
        for (unsigned lane = 0; lane < kPacket; ++lane) {
            const Receiver& receiver = receivers_[first + std::min(lane, count - 1)];
            valid[lane] = lane < count ? -1 : 0;
            rays.org_x[lane] = receiver.origin.x, rays.dir_x[lane] = receiver.to_light.x;
            rays.org_y[lane] = receiver.origin.y, rays.dir_y[lane] = receiver.to_light.y;
            rays.org_z[lane] = receiver.origin.z, rays.dir_z[lane] = receiver.to_light.z;
            rays.tnear[lane] = directional_ ? leave_ : leave_ / glm::length(receiver.to_light);
            rays.tfar[lane] = directional_ ? std::numeric_limits<float>::infinity() : 1.0f;
            rays.time[lane] = 0;
            rays.mask[lane] = ~0u;
        }
        RTCIntersectContext context = context_;
        rtcOccluded16(valid, scene_, &context, &rays);
        for (unsigned lane = 0; lane < count; ++lane) visible_[receivers_[first + lane].pixel] = rays.tfar[lane] >= 0;
    }

    RTCScene scene_;
    std::span<const Receiver> receivers_;
    bool directional_;
    float leave_;
    std::vector<std::uint8_t>& visible_;
    RTCIntersectContext context_;
};

/// Adds the wall time of its life, and the processor time of all threads meanwhile.
class Stopwatch {
public:
    Stopwatch(double& wall_ms, double& processor_ms) : wall_ms_(wall_ms), processor_ms_(processor_ms) {}
    ~Stopwatch() {
        wall_ms_ += clock_.elapsed_ms();
        processor_ms_ += 1e3 * double(std::clock() - processor_start_) / CLOCKS_PER_SEC;
    }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

private:
    double &wall_ms_, &processor_ms_;
    WallClock clock_;
    std::clock_t processor_start_ = std::clock();
};

std::vector<std::uint32_t> list_lights(const RenderRequest& request) {
    std::vector<std::uint32_t> lights;
    for (const LayerJob& job : request.jobs)
        if (std::find(lights.begin(), lights.end(), job.light) == lights.end()) lights.push_back(job.light);
    return lights;
}

}  // namespace

std::span<const ShadowRayMode> get_shadow_ray_modes() { return kModes; }

struct ShadowRays::Impl {
    explicit Impl(int threads) : pool(threads) {
        device = rtcNewDevice(("threads=" + std::to_string(pool.thread_count())).c_str());
        if (!device) throw std::runtime_error("Embree made no device");
    }
    ~Impl() { rtcReleaseDevice(device); }

    ThreadPool pool;
    RTCDevice device = nullptr;
};

ShadowRays::ShadowRays(int threads) : impl_(std::make_unique<Impl>(threads)) {}
ShadowRays::~ShadowRays() = default;

ShadowRayTimes ShadowRays::measure(const RenderRequest& request, const FrameResult& result, const ShadowRayMode& mode) {
    const Frame frame = make_frame(request, result);
    const Bounds bounds = compute_scene_bounds(*request.scene, kInstanceShadow);
    const double reach = bounds.is_empty() ? 1.0 : glm::length(bounds.max - bounds.min);
    ShadowRayTimes times;
    std::unique_ptr<EmbreeScene> embree;
    std::uint64_t built_for = 0;
    for (const std::uint32_t index : list_lights(request)) {
        const Light& light = request.scene->lights[index];
        const LightSample position = sample_light_shape(light, 1).front();
        const FacingRule rule(frame, light, position);
        std::vector<Receiver> receivers;
        {
            const Stopwatch watch(times.list_ms, times.processor_ms);
            receivers = ReceiverList(frame, rule).make(impl_->pool);
        }
        if (!embree || built_for != light.blocker_set) {
            embree = std::make_unique<EmbreeScene>(
                impl_->device, *request.scene, light, frame.origin_ws,
                mode.medium_quality ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_LOW, mode.instanced);
            built_for = light.blocker_set;
            const Stopwatch watch(times.build_ms, times.processor_ms);
            embree->build();
        }
        std::vector<std::uint8_t>& visible = times.visible.emplace_back(frame.pixel_count());
        for (std::size_t pixel = 0; pixel < visible.size(); ++pixel)
            visible[pixel] = get_unoccluded_visibility(rule.classify(pixel)) > 0;
        PacketTrace trace(embree->get(), receivers, position.directional, reach, visible);
        times.receivers += receivers.size();
        const Stopwatch watch(times.trace_ms, times.processor_ms);
        trace.run(impl_->pool);
    }
    return times;
}

}  // namespace shadow_layers::truth
