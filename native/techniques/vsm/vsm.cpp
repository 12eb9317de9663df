// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Variance shadow mapping: mean and mean square of the depths under a kernel bound the part of it that is lit.
// Based on: W. Donnelly, A. Lauritzen, Variance shadow maps, I3D 2006; the reduction of light bleeding from A.
// Lauritzen, M. McCool, Layered variance shadow maps, Graphics Interface 2008.
// Differences: biases and the least variance come from slope, kernel and rounding (docs/techniques/vsm.md).
// Fails: light bleeds where two casters lie behind each other, the more the farther apart they are.
#include "techniques/vsm/vsm.h"

#include "techniques/filtered_map.h"
#include "techniques/parameter_builder.h"
#include "techniques/prefilter_parameters.h"

namespace shadow_layers {
namespace {

TexelEncoding get_encoding(const ParameterValues& values) {
    if (has_16_bits(values)) return {.encode = "encode_variance_fixed", .format = GL_RG16, .fixed_point = true};
    return {.encode = "encode_variance", .format = GL_RG32F};
}

void set_uniforms(const gl::Program& program, const ParameterValues& values) {
    program.set("u_bleed_reduction", float(values.get_float("bleed_reduction")));
}

}  // namespace

TechniqueDescriptor describe_vsm() {
    return describe_filtered_map({
        .id = "vsm",
        .label = "VSM",
        .summary = "Variance shadow maps: a filtered mean and variance of depth bound how much of a footprint is lit",
        .reference = "Donnelly06",
        .limits = "Light bleeds into shadows that several casters at different depths throw",
        .parameters = {bleed_reduction_parameter(0.1)},
    });
}

std::unique_ptr<Technique> make_vsm() {
    return make_filtered_map(
        {.shader = "techniques/vsm/vsm.frag", .get_encoding = get_encoding, .set_uniforms = set_uniforms});
}

}  // namespace shadow_layers
