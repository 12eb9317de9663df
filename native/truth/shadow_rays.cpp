// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/shadow_rays.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/clock.h"
#include "base/thread_pool.h"
#include "frame/frame.h"
#include "lights/light_shape.h"
#include "lights/light_views.h"
#include "scene/bounds.h"
#include "truth/embree_scene.h"
#include "truth/ray_batches.h"

namespace shadow_layers::truth {
namespace {

constexpr ShadowRayMode kModes[] = {{"low quality", false, false},
                                    {"medium quality", true, false},
                                    {"low quality, instances", false, true},
                                    {"medium quality, instances", true, true}};

/// The frame as far as it is asked for.
Frame make_frame(const RenderRequest& request, const FrameResult& result) {
    Frame frame;
    frame.width = result.coverage.width, frame.height = result.coverage.height;
    frame.scene = request.scene;
    frame.origin_ws = result.camera_position;
    const Image &positions = result.aux.at("position"), &normals = result.aux.at("normal");
    for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
        const float *p = &positions.data[3 * pixel], *n = &normals.data[3 * pixel];
        const std::int64_t* id = &result.ids.data[2 * pixel];
        frame.positions_rel.emplace_back(p[0], p[1], p[2]);
        frame.normals.emplace_back(n[0], n[1], n[2]);
        frame.ids.push_back(id[0] < 0 ? PixelIds{} : PixelIds{std::uint32_t(id[0]), std::uint32_t(id[1])});
        frame.coverage.push_back(result.coverage.data[pixel] > 0);
    }
    return frame;
}

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

/// A light as the jobs sample it.
struct SampledLight {
    std::uint32_t light;
    int samples;
    LightPattern pattern;
    bool operator==(const SampledLight&) const = default;
};

std::vector<SampledLight> list_lights(const RenderRequest& request) {
    std::vector<SampledLight> lights;
    for (const LayerJob& job : request.jobs) {
        const TechniqueDescriptor& technique = find_technique_descriptor(job.technique);
        const TechniqueNeeds needs = technique.needs(resolve_parameters(technique, job.parameters));
        // Of one sample all patterns have the light's centre.
        const SampledLight light{job.light, needs.light_samples,
                                 needs.light_samples > 1 ? needs.light_pattern : LightPattern::Spiral};
        if (std::find(lights.begin(), lights.end(), light) == lights.end()) lights.push_back(light);
    }
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
    const double diameter = bounds.is_empty() ? 1.0 : glm::length(bounds.max - bounds.min);
    ShadowRayTimes times;
    std::unique_ptr<EmbreeScene> embree;
    std::uint64_t built_for = 0;
    for (const SampledLight& sampled : list_lights(request)) {
        const Light& light = request.scene->lights[sampled.light];
        const auto samples = sample_light_shape(light, sampled.samples, sampled.pattern);
        std::optional<RayList> rays;
        {
            const Stopwatch watch(times.list_ms, times.processor_ms);
            rays.emplace(frame, light, samples, diameter, impl_->pool);
        }
        if (!embree || built_for != light.blocker_set) {
            embree = std::make_unique<EmbreeScene>(
                impl_->device, *request.scene, light, frame.origin_ws,
                mode.medium_quality ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_LOW, mode.instanced);
            built_for = light.blocker_set;
            const Stopwatch watch(times.build_ms, times.processor_ms);
            embree->build();
        }
        times.receivers += rays->receiver_count();
        auto& lit = times.lit.emplace_back(frame.pixel_count());
        std::vector<std::uint16_t> streamed(frame.pixel_count());
        {
            const Stopwatch watch(times.packets_ms, times.processor_ms);
            times.rays += rays->trace_packets(embree->get(), impl_->pool, lit);
        }
        double other_ms = 0;
        {
            const Stopwatch watch(times.stream_ms, other_ms);
            rays->trace_stream(embree->get(), impl_->pool, streamed);
        }
        for (std::size_t pixel = 0; pixel < lit.size(); ++pixel)
            times.disagreements += std::size_t(std::abs(int(lit[pixel]) - int(streamed[pixel])));
    }
    return times;
}

}  // namespace shadow_layers::truth
