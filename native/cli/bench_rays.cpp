// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_rays.h"

#include <algorithm>

#include "shadow_layers/error.h"
#ifdef SHADOW_LAYERS_EMBREE
#include "truth/shadow_rays.h"
#endif

namespace shadow_layers::cli {

#ifdef SHADOW_LAYERS_EMBREE
struct RayBench::Rays {
    explicit Rays(int threads) : shadow_rays(threads) {}
    truth::ShadowRays shadow_rays;
};

RayBench::RayBench(int threads) : rays_(std::make_unique<Rays>(threads)) {
    for (const truth::ShadowRayMode& mode : truth::get_shadow_ray_modes()) rows_.emplace_back().name = mode.name;
}

void RayBench::measure(Session& session, const RenderRequest& request) {
    RenderRequest frame_request = request;
    frame_request.jobs.clear();
    frame_request.samples = 1;
    frame_request.aux = {"position", "normal", "ids"};
    const FrameResult frame = session.render(frame_request, [](Layer&&) {});
    for (RayRow& row : rows_) {
        const auto& mode = truth::get_shadow_ray_modes()[std::size_t(&row - rows_.data())];
        const truth::ShadowRayTimes times = rays_->shadow_rays.measure(request, frame, mode);
        row.list_ms.push_back(times.list_ms);
        row.build_ms.push_back(times.build_ms);
        row.packets_ms.push_back(times.packets_ms);
        row.stream_ms.push_back(times.stream_ms);
        row.trace_ms.push_back(std::min(times.packets_ms, times.stream_ms));
        row.processor_ms.push_back(times.processor_ms);
        row.receivers = times.receivers;
        row.rays = times.rays;
    }
}
#else
struct RayBench::Rays {};
RayBench::RayBench(int) {
    throw InputError("--rays: this shadowcore was built without Embree; build it with SHADOW_LAYERS_EMBREE=ON");
}
void RayBench::measure(Session&, const RenderRequest&) {}
#endif

RayBench::~RayBench() = default;

}  // namespace shadow_layers::cli
