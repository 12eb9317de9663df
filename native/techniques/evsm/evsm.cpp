// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exponential variance shadow mapping: variance shadow mapping of exponentially warped depths.
// Based on: A. Lauritzen, M. McCool, Layered variance shadow maps, Graphics Interface 2008, section 4.
// Differences: biases and the least variance come from slope, kernel and rounding (docs/techniques/evsm.md).
// Fails: light bleeds where both warps' bounds let it; 16 bits have no room for exponents that would hold it back.
#include "techniques/evsm/evsm.h"

#include "techniques/filtered_map.h"
#include "techniques/parameter_builder.h"
#include "techniques/prefilter_parameters.h"

namespace shadow_layers {
namespace {

/// The square of exp(c z), of a depth from -1 to 1, and its inverse both fit into the format.
constexpr double kMostExponent = 42, kMostExponent16 = 5.54;
/// What the two warps take by default; measured in docs/techniques/evsm.md.
constexpr double kAutomatic = 40, kAutomatic16 = kMostExponent16;

glm::dvec2 find_exponents(const ParameterValues& values) {
    return {choose_exponent(values, "positive_exponent", kAutomatic, kAutomatic16),
            choose_exponent(values, "negative_exponent", kAutomatic, kAutomatic16)};
}

bool has_four(const ParameterValues& values) { return values.get_enum("components") == "4"; }

TexelEncoding get_encoding(const ParameterValues& values) {
    const GLenum narrow = has_four(values) ? GL_RGBA16F : GL_RG16F, wide = has_four(values) ? GL_RGBA32F : GL_RG32F;
    return {.encode = "encode_exponential_variance",
            .format = has_16_bits(values) ? narrow : wide,
            .exponents = find_exponents(values)};
}

gl::Defines get_defines(const ParameterValues& values) { return {{"COMPONENTS", values.get_enum("components")}}; }

void set_uniforms(const gl::Program& program, const ParameterValues& values) {
    program.set("u_exponents", glm::vec2(find_exponents(values)));
    program.set("u_bleed_reduction", float(values.get_float("bleed_reduction")));
}

std::vector<ParameterSpec> list_own_parameters() {
    return {
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
        bleed_reduction_parameter(0.05),
    };
}

}  // namespace

TechniqueDescriptor describe_evsm() {
    return describe_filtered_map({
        .id = "evsm",
        .label = "EVSM",
        .summary = "Exponential variance shadow maps: Chebyshev's bound on depths warped so that little light bleeds",
        .reference = "Lauritzen08, section 4",
        .limits = "Some light bleeds near contacts in shadows of several casters; steep exponents cost precision",
        .parameters = list_own_parameters(),
        .check =
            [](const ParameterValues& values) {
                for (const char* exponent : {"positive_exponent", "negative_exponent"})
                    check_exponent("evsm", exponent, values, kMostExponent16);
            },
    });
}

std::unique_ptr<Technique> make_evsm() {
    return make_filtered_map({.shader = "techniques/evsm/evsm.frag",
                              .get_encoding = get_encoding,
                              .set_uniforms = set_uniforms,
                              .get_defines = get_defines});
}

}  // namespace shadow_layers
