// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/frame_set.h"

namespace shadow_layers {

FrameSet::FrameSet(Engine& engine, std::shared_ptr<FramePool> pool, const RenderRequest& request,
                   const PixelRect& region)
    : engine_(engine), pool_(std::move(pool)), request_(request), region_(region) {}

void FrameSet::begin_sample(const glm::dvec2& offset_px) {
    offset_px_ = offset_px;
    for (auto& [overscan_px, part] : parts_) part->frames.reset();
}

FrameSet::Part& FrameSet::get(int overscan_px) {
    std::unique_ptr<Part>& part = parts_[overscan_px];
    if (!part)
        part.reset(new Part{
            FrameMaker(engine_, pool_,
                       {request_.scene, request_.camera, request_.width, request_.height, region_, overscan_px}),
            LightCache(engine_, request_.samples > 1),
            {}});
    if (!part->frames) {
        part->frames.emplace(part->maker, offset_px_);
        part->lights.begin_sample(part->frames->centre());
    }
    return *part;
}

void FrameSet::forget(std::uint32_t light) {
    for (auto& [overscan_px, part] : parts_) part->lights.forget(light);
}

void FrameSet::clear_lights() {
    for (auto& [overscan_px, part] : parts_) part->lights.clear();
}

}  // namespace shadow_layers
