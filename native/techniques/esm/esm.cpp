// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exponential shadow mapping: the depth test as exp(c (caster - receiver)), so that exp(c caster) can be filtered.
// Based on: T. Annen, T. Mertens, H.-P. Seidel, E. Flerackers, J. Kautz, Exponential shadow maps, Graphics Interface
// 2008. Differences: no fallback where the footprint holds something behind the receiver; biases from slope, kernel and
// rounding (docs/techniques/esm.md). Fails: light leaks in near the contact of caster and receiver, and where parts of
// the footprint lie behind the receiver.
#include "techniques/esm/esm.h"

#include "stages/moment_resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"
#include "techniques/prefilter_parameters.h"

namespace shadow_layers {
namespace {

/// exp(c z) of the depths of shaders/lib/linear_depth_lib.glsl, which lie 1.8 apart from near to far, and its inverse
/// both fit into the format: 150 / 1.8 is below ln 2^126, 19 / 1.8 below ln 65504.
constexpr double kMostExponent = 150, kMostExponent16 = 19, kNearToFar = 1.8;
/// The papers' exponent, and what 16 bits have room for.
constexpr double kAutomatic = 80, kAutomatic16 = kMostExponent16;

double find_exponent(const ParameterValues& values) {
    return choose_exponent(values, "exponent", kAutomatic, kAutomatic16) / kNearToFar;
}

MomentMapOptions esm_options(const ParameterValues& values) {
    MomentMapOptions options = prefilter_options(values);
    options.encode = "encode_exponential";
    options.format = has_16_bits(values) ? GL_R16F : GL_R32F;
    options.exponents = glm::dvec2(find_exponent(values), 0);
    return options;
}

class ESM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        gl::Defines defines = prefilter_defines(parameters);
        program_ = &engine.program("frame/fullscreen.vert", "techniques/esm/esm.frag", defines);
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const auto set_uniforms = [&] { program_->set("u_exponent", float(find_exponent(task.parameters))); };
        outputs.set("visibility", pass_.run(engine, task.frame, task.light, task.positions.front(),
                                            esm_options(task.parameters), *program_, set_uniforms));
    }

private:
    const gl::Program* program_ = nullptr;
    MomentResolvePass pass_;
};

std::vector<ParameterSpec> esm_parameters() {
    return prefilter_parameters({
        float_parameter("exponent", "Exponent", 0)
            .range(0, kMostExponent)
            .help("How steeply the test falls over the view's depth; 0: 80, or 19 with 16 bits"),
    });
}

}  // namespace

TechniqueDescriptor describe_esm() {
    TechniqueDescriptor d;
    d.id = "esm";
    d.label = "ESM";
    d.summary = "Exponential shadow maps: the depth test as an exponential that can be filtered beforehand";
    d.reference = "Annen08";
    d.limits = "Light leaks at contacts, and where the footprint holds surfaces behind the receiver";
    d.parameters = esm_parameters();
    d.outputs = visibility_output();
    d.lights = all_light_kinds();
    d.meshes = "any";
    d.needs = prefilter_needs;
    d.truth = prefilter_truth;
    d.check = [](const ParameterValues& values) { check_exponent("esm", "exponent", values, kMostExponent16); };
    return d;
}

std::unique_ptr<Technique> make_esm() { return std::make_unique<ESM>(); }

}  // namespace shadow_layers
