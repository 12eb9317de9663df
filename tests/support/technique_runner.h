// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Runs a technique as the session does, step by step, so that tests see frame, views and maps.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "context/context.h"
#include "engine/engine.h"
#include "frame/frame_maker.h"
#include "lights/light_views.h"
#include "session/light_render.h"
#include "shadow_layers/technique_descriptor.h"
#include "support/technique_scenes.h"
#include "techniques/technique.h"

namespace shadow_layers::testing {

/// Keeps what a technique fills in, as pictures of the frame's size.
class KeptOutputs final : public LayerOutputs {
public:
    void set(const std::string& channel, const gl::Texture& texture) override {
        Image image;
        image.width = texture.width(), image.height = texture.height();
        image.channels = texture.format() == GL_R32F ? 1 : texture.format() == GL_RGB32F ? 3 : 4;
        image.data = texture.download<float>();
        images[channel] = std::move(image);
    }
    void set(const std::string& channel, Image image) override { images[channel] = std::move(image); }
    std::map<std::string, Image> images;
};

struct TechniqueRun {
    std::shared_ptr<const Frame> frame;
    std::vector<LightSample> positions;
    std::map<std::string, Image> channels;
    RenderStats stats;
    const std::vector<float>& visibility() const { return channels.at("visibility").data; }
};

class TechniqueRunner {
public:
    explicit TechniqueRunner(int threads = 2) : context_(make_context("osmesa", threads)) {
        context_->make_current();
        EngineOptions options;
        options.shader_dir = SHADOW_LAYERS_SHADER_DIR;
        options.threads = threads;
        options.debug = true;
        engine_ = std::make_unique<Engine>(*context_, options);
        pool_ = std::make_shared<FramePool>();
    }

    Engine& engine() { return *engine_; }

    TechniqueRun render(const SceneView& view, const std::string& technique, const ParameterValues& given = {},
                        std::size_t light = 0, PixelRect region = {}) {
        const TechniqueEntry& entry = find_entry(technique);
        const TechniqueDescriptor descriptor = make_descriptor(entry);
        const ParameterValues values = resolve_parameters(descriptor, given);
        const TechniqueNeeds needs = descriptor.needs(values);
        if (region.width == 0) region = {0, 0, view.width, view.height};
        auto& made = techniques_[technique];
        if (!made) made = entry.make();
        made->prepare(*engine_, values);

        TechniqueRun run;
        StageRecord record;
        engine_->set_record(&record);
        FrameMaker maker(*engine_, pool_,
                         {view.scene, view.camera, view.width, view.height, region, needs.overscan_px});
        run.frame = maker.make(glm::dvec2(0.0));
        SampleFrames frames(maker, glm::dvec2(0.0));
        const Light& source = view.scene->lights[light];
        const ViewSettings settings{needs.map_size, needs.map_border_texels, needs.separate_samples(),
                                    needs.light_pattern};
        run.positions = make_light_samples(*run.frame, source, settings, nullptr, &engine_->threads());
        KeptOutputs outputs;
        const LightSamples samples{int(run.positions.size()), [&](int index) {
                                       const std::shared_ptr<void> not_owned;
                                       return std::shared_ptr<const LightSample>(not_owned,
                                                                                 &run.positions[std::size_t(index)]);
                                   }};
        light_render_.render(*engine_, *made, {frames.centre(), frames, source, descriptor, values, needs}, samples,
                             outputs);
        run.stats = record.stats();
        engine_->set_record(nullptr);
        engine_->check_cancelled();
        run.channels = std::move(outputs.images);
        return run;
    }

private:
    static const TechniqueEntry& find_entry(const std::string& id) {
        for (const TechniqueEntry& entry : technique_entries())
            if (entry.describe().id == id) return entry;
        throw std::runtime_error("no technique " + id);
    }
    std::unique_ptr<Context> context_;
    std::unique_ptr<Engine> engine_;
    std::shared_ptr<FramePool> pool_;
    std::map<std::string, std::unique_ptr<Technique>> techniques_;
    LightRender light_render_;
};

inline ParameterValues parameters(std::initializer_list<std::pair<const char*, ParameterValue>> items) {
    ParameterValues values;
    for (const auto& [id, value] : items) values.set(id, value);
    return values;
}

}  // namespace shadow_layers::testing
