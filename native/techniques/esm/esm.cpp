// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exponential shadow mapping: the depth test as exp(c (caster - receiver)), so that exp(c caster) can be filtered.
// Based on: T. Annen, T. Mertens, H.-P. Seidel, E. Flerackers, J. Kautz, Exponential shadow maps, Graphics Interface
// 2008. Differences: no fallback where the footprint holds something behind the receiver; biases from slope, kernel and
// rounding (docs/techniques/esm.md). Fails: light leaks in near the contact of caster and receiver, and where parts of
// the footprint lie behind the receiver.
#include "techniques/esm/esm.h"

#include "techniques/filtered_map.h"
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

TexelEncoding get_encoding(const ParameterValues& values) {
    return {.encode = "encode_exponential",
            .format = GLenum(has_16_bits(values) ? GL_R16F : GL_R32F),
            .exponents = {find_exponent(values), 0}};
}

void set_uniforms(const gl::Program& program, const ParameterValues& values) {
    program.set("u_exponent", float(find_exponent(values)));
}

}  // namespace

TechniqueDescriptor describe_esm() {
    return describe_filtered_map({
        .id = "esm",
        .label = "ESM",
        .summary = "Exponential shadow maps: the depth test as an exponential that can be filtered beforehand",
        .reference = "Annen08",
        .limits = "Light leaks at contacts, and where the footprint holds surfaces behind the receiver",
        .parameters =
            {
                float_parameter("exponent", "Exponent", 0)
                    .range(0, kMostExponent)
                    .help("How steeply the test falls over the view's depth; 0: 80, or 19 with 16 bits"),
            },
        .check = [](const ParameterValues& values) { check_exponent("esm", "exponent", values, kMostExponent16); },
    });
}

std::unique_ptr<Technique> make_esm() {
    return make_filtered_map(
        {.shader = "techniques/esm/esm.frag", .get_encoding = get_encoding, .set_uniforms = set_uniforms});
}

}  // namespace shadow_layers
