// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "engine/picture_upload.h"
#include "stages/light_mean.h"
#include "techniques/technique.h"

namespace shadow_layers {

/// A light of a frame for one technique.
struct LightJob {
    const Frame& frame;
    FrameSource& frames;
    const Light& light;
    const TechniqueDescriptor& descriptor;
    const ParameterValues& parameters;
    const TechniqueNeeds& needs;
    int picture_sample = 0;  ///< as in LightTask
};

/// The samples that the technique is called for, made when asked for.
struct LightSamples {
    int count = 1;  ///< 1 also for a light without size
    std::function<std::shared_ptr<const LightSample>(int index)> get;
};

/// Goes through the samples of a light: calls the technique for each and averages what it answers. The visibility is
/// weighed by the light that each sample brings; other channels have their plain mean. Keeps its pictures.
class LightRender {
public:
    /// Fills all channels that the descriptor declares. Counts "light_samples" where more than one is asked for.
    void render(Engine& engine, Technique& technique, const LightJob& job, const LightSamples& samples,
                LayerOutputs& outputs);

private:
    class MeanOutputs;
    void render_many(Engine& engine, Technique& technique, const LightJob& job, const LightSamples& samples,
                     LayerOutputs& outputs);

    LightMean mean_;
    PictureUpload upload_;
};

}  // namespace shadow_layers
