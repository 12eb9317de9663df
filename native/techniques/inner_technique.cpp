// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/inner_technique.h"

#include <algorithm>

#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

/// Keeps the visibility and drops the other outputs.
class VisibilityCatcher final : public LayerOutputs {
public:
    VisibilityCatcher(Engine& engine, std::shared_ptr<gl::Texture>& upload) : engine_(engine), upload_(upload) {}

    void set(const std::string& channel, const gl::Texture& texture) override {
        if (channel == "visibility") found_ = &texture;
    }
    void set(const std::string& channel, Image image) override {
        if (channel != "visibility") return;
        if (!upload_ || upload_->width() != image.width || upload_->height() != image.height)
            upload_ = std::make_shared<gl::Texture>(
                engine_.device(), gl::TextureDesc{GL_R32F, image.width, image.height}, "inner visibility");
        upload_->upload(image.data.data());
        found_ = upload_.get();
    }
    const gl::Texture* found() const { return found_; }

private:
    Engine& engine_;
    std::shared_ptr<gl::Texture>& upload_;
    const gl::Texture* found_ = nullptr;
};

}  // namespace

struct InnerTechnique::Made {
    TechniqueDescriptor descriptor;
    std::unique_ptr<Technique> technique;
    ParameterValues parameters;
    std::shared_ptr<gl::Texture> upload_tx;
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
    VisibilityCatcher catcher(engine, current_->upload_tx);
    current_->technique->render(engine, {task.frame, task.frames, task.light, task.positions, current_->parameters},
                                catcher);
    if (!catcher.found()) throw Error("technique \"" + current_->descriptor.id + "\" gave no visibility");
    return *catcher.found();
}

TechniqueNeeds find_inner_needs(const std::string& id, const ParameterValues& given) {
    const TechniqueDescriptor& descriptor = find_technique_descriptor(id);
    return descriptor.needs ? descriptor.needs(resolve_parameters(descriptor, given)) : TechniqueNeeds{};
}

}  // namespace shadow_layers
