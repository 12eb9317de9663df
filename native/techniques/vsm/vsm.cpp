// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Variance shadow mapping: mean and mean square of the depths under a kernel bound the part of it that is lit.
// Based on: W. Donnelly, A. Lauritzen, Variance shadow maps, I3D 2006; the reduction of light bleeding from A.
// Lauritzen, M. McCool, Layered variance shadow maps, Graphics Interface 2008.
// Differences: biases and the least variance come from slope, kernel and rounding (docs/techniques/vsm.md).
// Fails: light bleeds where two casters lie behind each other, the more the farther apart they are.
#include "techniques/vsm/vsm.h"

#include "stages/moment_resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"
#include "techniques/prefilter_parameters.h"

namespace shadow_layers {
namespace {

MomentMapOptions vsm_options(const ParameterValues& values) {
    MomentMapOptions options = prefilter_options(values);
    options.encode = has_16_bits(values) ? "encode_variance_fixed" : "encode_variance";
    options.format = has_16_bits(values) ? GL_RG16 : GL_RG32F;
    return options;
}

class VSM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        gl::Defines defines = prefilter_defines(parameters);
        defines.emplace("FIXED_POINT", has_16_bits(parameters) ? "1" : "0");
        program_ = &engine.program("frame/fullscreen.vert", "techniques/vsm/vsm.frag", defines);
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const auto set_uniforms = [&] {
            program_->set("u_bleed_reduction", float(task.parameters.get_float("bleed_reduction")));
        };
        outputs.set("visibility", pass_.run(engine, task.frame, task.light, task.positions.front(),
                                            vsm_options(task.parameters), *program_, set_uniforms));
    }

private:
    const gl::Program* program_ = nullptr;
    MomentResolvePass pass_;
};

std::vector<ParameterSpec> vsm_parameters() {
    return prefilter_parameters({
        float_parameter("bleed_reduction", "Bleed Reduction", 0.1)
            .range(0, 0.95)
            .help("Bounds up to this become full shadow: less light bleeds in, and borders get darker and sharper"),
    });
}

}  // namespace

TechniqueDescriptor describe_vsm() {
    TechniqueDescriptor d;
    d.id = "vsm";
    d.label = "VSM";
    d.summary = "Variance shadow maps: a filtered mean and variance of depth bound how much of a footprint is lit";
    d.reference = "Donnelly06";
    d.limits = "Light bleeds into shadows that several casters at different depths throw";
    d.parameters = vsm_parameters();
    d.outputs = visibility_output();
    d.lights = all_light_kinds();
    d.meshes = "any";
    d.needs = prefilter_needs;
    d.truth = prefilter_truth;
    return d;
}

std::unique_ptr<Technique> make_vsm() { return std::make_unique<VSM>(); }

}  // namespace shadow_layers
