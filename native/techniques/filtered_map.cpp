// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/filtered_map.h"

#include "stages/resolve.h"
#include "techniques/prefilter_parameters.h"

namespace shadow_layers {
namespace {

class FilteredMap final : public Technique {
public:
    explicit FilteredMap(const FilteredMapKind& kind) : kind_(kind) {}

    void prepare(Engine& engine, const ParameterValues& parameters) override {
        gl::Defines defines = prefilter_defines(parameters);
        defines.emplace("FIXED_POINT", kind_.get_encoding(parameters).fixed_point ? "1" : "0");
        if (kind_.get_defines) defines.merge(kind_.get_defines(parameters));
        program_ = &engine.program("frame/fullscreen.vert", kind_.shader, defines);
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const LightSample& sample = task.sample;
        const auto depths = render_depth_map(engine, *task.frame.scene, sample);
        const auto map = render_moment_map(engine, sample, *depths, get_map_options(task.parameters));
        const auto bind = [&] {
            map->bind(*program_);
            kind_.set_uniforms(*program_, task.parameters);
        };
        outputs.set("visibility", resolve_.run(engine, {.frame = task.frame,
                                                        .light = task.light,
                                                        .sample = sample,
                                                        .program = *program_,
                                                        .work_per_pixel = 4,
                                                        .bind_inputs = bind}));
    }

private:
    MomentMapOptions get_map_options(const ParameterValues& parameters) const {
        const TexelEncoding encoding = kind_.get_encoding(parameters);
        MomentMapOptions options = prefilter_options(parameters);
        options.encode = encoding.encode;
        options.format = encoding.format;
        options.exponents = encoding.exponents;
        return options;
    }

    FilteredMapKind kind_;
    const gl::Program* program_ = nullptr;
    ResolvePass resolve_;
};

}  // namespace

std::unique_ptr<Technique> make_filtered_map(const FilteredMapKind& kind) {
    return std::make_unique<FilteredMap>(kind);
}

TechniqueDescriptor describe_filtered_map(TechniqueDescriptor own) {
    own.parameters = prefilter_parameters(std::move(own.parameters));
    own.needs = prefilter_needs;
    own.truth = prefilter_truth;
    return own;
}

}  // namespace shadow_layers
