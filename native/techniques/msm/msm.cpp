// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Moment shadow mapping: four moments of the depths under a kernel give the least part of it that can block.
// Based on: C. Peters, R. Klein, Moment shadow mapping, I3D 2015; C. Peters, C. Muenstermann, N. Wetzstein, R. Klein,
// Improved moment shadow maps for translucent occluders, soft shadows and single scattering, JCGT 2017.
// Differences: the receiver's bias is a standard deviation of its own plane under the kernel; what the moment bias
// lends is taken off again (docs/techniques/msm.md).
// Fails: some light leaks into shadows of three casters and more at different depths; contacts leak by the bias.
#include "techniques/msm/msm.h"

#include "stages/moment_resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"
#include "techniques/prefilter_parameters.h"

namespace shadow_layers {
namespace {

/// Of the mass, by the format. [Peters17] gives 3e-7 for 32 bits; here a blur's roundings come before that of storing,
/// and pictures of one scene at two scales differ visibly up to 1e-6.
constexpr double kBias32 = 3e-6, kBias16 = 6e-5;

double find_moment_bias(const ParameterValues& values) {
    const double given = 1e-6 * values.get_float("moment_bias");
    return given > 0 ? given : has_16_bits(values) ? kBias16 : kBias32;
}

MomentMapOptions msm_options(const ParameterValues& values) {
    MomentMapOptions options = prefilter_options(values);
    options.encode = has_16_bits(values) ? "encode_moments_fixed" : "encode_moments";
    options.format = has_16_bits(values) ? GL_RGBA16 : GL_RGBA32F;
    return options;
}

class MSM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        gl::Defines defines = prefilter_defines(parameters);
        defines.emplace("FIXED_POINT", has_16_bits(parameters) ? "1" : "0");
        program_ = &engine.program("frame/fullscreen.vert", "techniques/msm/msm.frag", defines);
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const auto set_uniforms = [&] {
            program_->set("u_moment_bias", float(find_moment_bias(task.parameters)));
            program_->set("u_bleed_reduction", float(task.parameters.get_float("bleed_reduction")));
        };
        outputs.set("visibility", pass_.run(engine, task.frame, task.light, task.positions.front(),
                                            msm_options(task.parameters), *program_, set_uniforms));
    }

private:
    const gl::Program* program_ = nullptr;
    MomentResolvePass pass_;
};

std::vector<ParameterSpec> msm_parameters() {
    return prefilter_parameters({
        float_parameter("moment_bias", "Moment Bias", 0)
            .range(0, 10000)
            .unit("ppm")
            .help("Part of the moments given up for stability; 0: what the format needs, 3 or 60"),
        float_parameter("bleed_reduction", "Bleed Reduction", 0.02)
            .range(0, 0.95)
            .help("Scales the shadow by 1 / (1 - this), so that what the bound leaves of full shadow does not show"),
    });
}

}  // namespace

TechniqueDescriptor describe_msm() {
    TechniqueDescriptor d;
    d.id = "msm";
    d.label = "MSM";
    d.summary = "Moment shadow maps: four filtered moments of depth give the least that can block a footprint";
    d.reference = "Peters15";
    d.limits = "Some light leaks into shadows of three or more casters, and at contacts by the slope's bias";
    d.parameters = msm_parameters();
    d.outputs = visibility_output();
    d.lights = all_light_kinds();
    d.meshes = "any";
    d.needs = prefilter_needs;
    d.truth = prefilter_truth;
    return d;
}

std::unique_ptr<Technique> make_msm() { return std::make_unique<MSM>(); }

}  // namespace shadow_layers
