// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Moment shadow mapping: four moments of the depths under a kernel give the least part of it that can block.
// Based on: C. Peters, R. Klein, Moment shadow mapping, I3D 2015; C. Peters, C. Muenstermann, N. Wetzstein, R. Klein,
// Improved moment shadow maps for translucent occluders, soft shadows and single scattering, JCGT 2017.
// Differences: the receiver's bias is a standard deviation of its own plane under the kernel; what the moment bias
// lends is taken off again (docs/techniques/msm.md).
// Fails: some light leaks into shadows of three casters and more at different depths; contacts leak by the bias.
#include "techniques/msm/msm.h"

#include "techniques/filtered_map.h"
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

TexelEncoding get_encoding(const ParameterValues& values) {
    if (has_16_bits(values)) return {.encode = "encode_moments_fixed", .format = GL_RGBA16, .fixed_point = true};
    return {.encode = "encode_moments", .format = GL_RGBA32F};
}

void set_uniforms(const gl::Program& program, const ParameterValues& values) {
    program.set("u_moment_bias", float(find_moment_bias(values)));
    program.set("u_bleed_reduction", float(values.get_float("bleed_reduction")));
}

std::vector<ParameterSpec> list_own_parameters() {
    return {
        float_parameter("moment_bias", "Moment Bias", 0)
            .range(0, 10000)
            .unit("ppm")
            .help("Part of the moments given up for stability; 0: what the format needs, 3 or 60"),
        float_parameter("bleed_reduction", "Bleed Reduction", 0.02)
            .range(0, 0.95)
            .help("Scales the shadow by 1 / (1 - this), so that what the bound leaves of full shadow does not show"),
    };
}

}  // namespace

TechniqueDescriptor describe_msm() {
    return describe_filtered_map({
        .id = "msm",
        .label = "MSM",
        .summary = "Moment shadow maps: four filtered moments of depth give the least that can block a footprint",
        .reference = "Peters15",
        .limits = "Some light leaks into shadows of three or more casters, and at contacts by the slope's bias",
        .parameters = list_own_parameters(),
    });
}

std::unique_ptr<Technique> make_msm() {
    return make_filtered_map(
        {.shader = "techniques/msm/msm.frag", .get_encoding = get_encoding, .set_uniforms = set_uniforms});
}

}  // namespace shadow_layers
