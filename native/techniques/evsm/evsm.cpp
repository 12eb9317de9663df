// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exponential variance shadow mapping: variance shadow mapping of exponentially warped depths.
// Based on: A. Lauritzen, M. McCool, Layered variance shadow maps, Graphics Interface 2008, section 4.
// Differences: biases and the least variance come from slope, kernel and rounding (docs/techniques/evsm.md).
// Fails: light bleeds where both warps' bounds let it; 16 bits have no room for exponents that would hold it back.
#include "techniques/evsm/evsm.h"

#include "stages/moment_resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"
#include "techniques/prefilter_parameters.h"

namespace shadow_layers {
namespace {

/// The square of exp(c z), of a depth from -1 to 1, and its inverse both fit into the format.
constexpr double kMostExponent = 42, kMostExponent16 = 5.54;
/// What the two warps take if they are not told; measured in docs/techniques/evsm.md.
constexpr double kAutomatic = 40, kAutomatic16 = kMostExponent16;

glm::dvec2 find_exponents(const ParameterValues& values) {
    return {choose_exponent(values, "positive_exponent", kAutomatic, kAutomatic16),
            choose_exponent(values, "negative_exponent", kAutomatic, kAutomatic16)};
}

bool has_four(const ParameterValues& values) { return values.get_enum("components") == "4"; }

MomentMapOptions evsm_options(const ParameterValues& values) {
    MomentMapOptions options = prefilter_options(values);
    options.encode = "encode_exponential_variance";
    if (has_16_bits(values))
        options.format = has_four(values) ? GL_RGBA16F : GL_RG16F;
    else
        options.format = has_four(values) ? GL_RGBA32F : GL_RG32F;
    options.exponents = find_exponents(values);
    return options;
}

class EVSM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        gl::Defines defines = prefilter_defines(parameters);
        defines.emplace("COMPONENTS", parameters.get_enum("components"));
        program_ = &engine.program("frame/fullscreen.vert", "techniques/evsm/evsm.frag", defines);
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const auto set_uniforms = [&] {
            program_->set("u_exponents", glm::vec2(find_exponents(task.parameters)));
            program_->set("u_bleed_reduction", float(task.parameters.get_float("bleed_reduction")));
        };
        outputs.set("visibility", pass_.run(engine, task.frame, task.light, task.positions.front(),
                                            evsm_options(task.parameters), *program_, set_uniforms));
    }

private:
    const gl::Program* program_ = nullptr;
    MomentResolvePass pass_;
};

std::vector<ParameterSpec> evsm_parameters() {
    return prefilter_parameters({
        enum_parameter("components", "Components", "4")
            .help("How many numbers a texel holds")
            .item("2", "2", "The positive warp and its square")
            .item("4", "4", "Both warps and their squares: less light bleeds in"),
        float_parameter("positive_exponent", "Positive Exponent", 0)
            .range(0, kMostExponent)
            .help("Of the warp that holds back light behind the first caster; 0: 40, or 5.54 with 16 bits"),
        float_parameter("negative_exponent", "Negative Exponent", 0)
            .range(0, kMostExponent)
            .help("Of the warp that holds back light at the receiver; 0: 40, or 5.54 with 16 bits"),
        float_parameter("bleed_reduction", "Bleed Reduction", 0.05)
            .range(0, 0.95)
            .help("Bounds up to this become full shadow: less light bleeds in, and borders get darker and sharper"),
    });
}

}  // namespace

TechniqueDescriptor describe_evsm() {
    TechniqueDescriptor d;
    d.id = "evsm";
    d.label = "EVSM";
    d.summary = "Exponential variance shadow maps: Chebyshev's bound on depths warped so that little light bleeds";
    d.reference = "Lauritzen08, section 4";
    d.limits = "Some light bleeds near contacts in shadows of several casters; steep exponents cost precision";
    d.parameters = evsm_parameters();
    d.outputs = visibility_output();
    d.lights = all_light_kinds();
    d.meshes = "any";
    d.needs = prefilter_needs;
    d.truth = prefilter_truth;
    d.check = [](const ParameterValues& values) {
        check_exponent("evsm", "positive_exponent", values, kMostExponent16);
        check_exponent("evsm", "negative_exponent", values, kMostExponent16);
    };
    return d;
}

std::unique_ptr<Technique> make_evsm() { return std::make_unique<EVSM>(); }

}  // namespace shadow_layers
