// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "frame/frame_maker.h"
#include "session/light_cache.h"
#include "shadow_layers/request.h"

namespace shadow_layers {

/// The frames of a picture sample, one for each overscan that jobs ask for, with the light samples that are fitted to
/// its receivers: a layer is the same whatever other layers are asked for beside it.
class FrameSet {
public:
    FrameSet(Engine& engine, std::shared_ptr<FramePool> pool, const RenderRequest& request, const PixelRect& region);

    struct Part {
        FrameMaker maker;
        LightCache lights;
        std::optional<SampleFrames> frames;  ///< of the current sample
    };

    /// Lets go of the sample before.
    void begin_sample(const glm::dvec2& offset_px);
    /// Made when first asked for. Valid until the next sample.
    Part& get(int overscan_px);
    /// No later job of the render wants this light.
    void forget(std::uint32_t light);
    void clear_lights();

private:
    Engine& engine_;
    std::shared_ptr<FramePool> pool_;
    const RenderRequest& request_;
    PixelRect region_;
    glm::dvec2 offset_px_{0.0};
    std::map<int, std::unique_ptr<Part>> parts_;
};

}  // namespace shadow_layers
