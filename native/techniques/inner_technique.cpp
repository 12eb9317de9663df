// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/inner_technique.h"

#include <algorithm>

#include "engine/picture_upload.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

/// Keeps the visibility.
class VisibilityCatcher final : public LayerOutputs {
public:
    VisibilityCatcher(Engine& engine, PictureUpload& upload) : engine_(engine), upload_(upload) {}

    void set(const std::string&, const gl::Texture& texture) override { found_ = &texture; }
    void set(const std::string&, Image image) override { found_ = &upload_.put(engine_, image); }
    const gl::Texture* found() const { return found_; }

private:
    Engine& engine_;
    PictureUpload& upload_;
    const gl::Texture* found_ = nullptr;
};

/// Hands the visibility on and drops the other outputs.
class VisibilityAlone final : public LayerOutputs {
public:
    explicit VisibilityAlone(LayerOutputs& outputs) : outputs_(outputs) {}

    void set(const std::string& channel, const gl::Texture& texture) override {
        if (channel == "visibility") outputs_.set(channel, texture);
    }
    void set(const std::string& channel, Image image) override {
        if (channel == "visibility") outputs_.set(channel, std::move(image));
    }

private:
    LayerOutputs& outputs_;
};

}  // namespace

struct InnerTechnique::Made {
    TechniqueDescriptor descriptor;
    std::unique_ptr<Technique> technique;
    ParameterValues parameters;
    PictureUpload upload;
};

InnerTechnique::InnerTechnique() = default;
InnerTechnique::~InnerTechnique() = default;
InnerTechnique::InnerTechnique(InnerTechnique&&) noexcept = default;
InnerTechnique& InnerTechnique::operator=(InnerTechnique&&) noexcept = default;

void InnerTechnique::prepare(Engine& engine, const std::string& id, const ParameterValues& given) {
    const auto is_wanted = [&](const auto& made) { return made->descriptor.id == id; };
    auto made = std::find_if(made_.begin(), made_.end(), is_wanted);
    if (made == made_.end()) {
        auto fresh = std::make_unique<Made>();
        fresh->descriptor = find_technique_descriptor(id);
        for (const TechniqueEntry& entry : technique_entries())
            if (entry.describe().id == id) fresh->technique = entry.make();
        made = made_.insert(made_.end(), std::move(fresh));
    }
    current_ = made->get();
    current_->parameters = resolve_parameters(current_->descriptor, given);
    current_->technique->prepare(engine, current_->parameters);
}

const gl::Texture& InnerTechnique::render(Engine& engine, const LightTask& task) {
    if (!current_) throw Error("an inner technique renders before it is prepared");
    VisibilityCatcher catcher(engine, current_->upload);
    render(engine, task, catcher);
    if (!catcher.found()) throw Error("technique \"" + current_->descriptor.id + "\" gave no visibility");
    return *catcher.found();
}

void InnerTechnique::render(Engine& engine, const LightTask& task, LayerOutputs& outputs) {
    if (!current_) throw Error("an inner technique renders before it is prepared");
    VisibilityAlone visibility(outputs);
    current_->technique->render(
        engine, {task.frame, task.frames, task.light, task.sample, current_->parameters, task.picture_sample},
        visibility);
}

TechniqueNeeds find_inner_needs(const std::string& id, const ParameterValues& given) {
    const TechniqueDescriptor& descriptor = find_technique_descriptor(id);
    return descriptor.needs ? descriptor.needs(resolve_parameters(descriptor, given)) : TechniqueNeeds{};
}

}  // namespace shadow_layers
