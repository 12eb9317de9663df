// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_rays.h"

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
    for (const truth::ShadowRayMode& mode : truth::get_shadow_ray_modes())
        rows_.push_back({mode.name, {}, {}, {}, {}, 0});
}

void RayBench::measure(Session& session, const RenderRequest& request, bool counts) {
    RenderRequest frame_request = request;
    frame_request.jobs.clear();
    frame_request.samples = 1;
    frame_request.aux = {"position", "normal", "ids"};
    const FrameResult frame = session.render(frame_request, [](Layer&&) {});
    for (RayRow& row : rows_) {
        const auto& mode = truth::get_shadow_ray_modes()[std::size_t(&row - rows_.data())];
        const truth::ShadowRayTimes times = rays_->shadow_rays.measure(request, frame, mode);
        if (!counts) continue;
        row.list_ms.push_back(times.list_ms);
        row.build_ms.push_back(times.build_ms);
        row.trace_ms.push_back(times.trace_ms);
        row.processor_ms.push_back(times.processor_ms);
        row.receivers = times.receivers;
    }
}
#else
struct RayBench::Rays {};
RayBench::RayBench(int) {
    throw InputError("--rays: this shadowcore was built without Embree; build it with SHADOW_LAYERS_EMBREE=ON");
}
void RayBench::measure(Session&, const RenderRequest&, bool) {}
#endif

RayBench::~RayBench() = default;

}  // namespace shadow_layers::cli
