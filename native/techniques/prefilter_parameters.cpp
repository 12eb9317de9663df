// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/prefilter_parameters.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

#include "moment_limits.h"
#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {
namespace {

/// A part of the map this small is the longest side of a pixel's footprint that mipmaps serve; the views' border grows
/// with it.
constexpr int kMapPerFootprint = 64;
constexpr int kWidestFootprint = 64;

bool has_mipmaps(const ParameterValues& values) {
    return values.get_bool("mipmaps") || values.get_int("anisotropy") > 1;
}

}  // namespace

std::vector<ParameterSpec> prefilter_parameters(std::vector<ParameterSpec> own) {
    std::vector<ParameterSpec> all{
        map_size_parameter(),
        int_parameter("blur_radius", "Blur Radius", 1)
            .range(0, kMostBlurTexels)
            .unit("texels")
            .help("How far the map's blur reaches; 1 averages 3 x 3 texels, 0 none but the four round a lookup"),
        enum_parameter("filter", "Filter", "gaussian")
            .help("Kernel of the blur")
            .item("box", "Box", "All texels weigh the same")
            .item("gaussian", "Gaussian", "Standard deviation of a quarter of the kernel's width"),
        bool_parameter("mipmaps", "Mipmaps", false)
            .help("Average over a pixel's whole footprint in the map where it is larger than a texel"),
        int_parameter("anisotropy", "Anisotropy", 1)
            .range(1, 16)
            .unit("lookups")
            .help("Most lookups along a footprint's longer side; above 1 mipmaps are on"),
        enum_parameter("bits", "Bits", "32")
            .help("Precision of each component of the map")
            .item("32", "32", "32-bit floats")
            .item("16", "16", "Half the memory, with what is lost to rounding"),
    };
    std::move(own.begin(), own.end(), std::back_inserter(all));
    return all;
}

ParameterSpec bleed_reduction_parameter(double default_value) {
    return float_parameter("bleed_reduction", "Bleed Reduction", default_value)
        .range(0, 0.95)
        .help("Bounds up to this become full shadow: less light bleeds in, and borders get darker and sharper");
}

bool has_16_bits(const ParameterValues& values) { return values.get_enum("bits") == "16"; }

MomentMapOptions prefilter_options(const ParameterValues& values) {
    MomentMapOptions options;
    options.radius = int(values.get_int("blur_radius"));
    options.filter = values.get_enum("filter") == "box" ? BlurFilter::Box : BlurFilter::Gaussian;
    if (has_mipmaps(values)) {
        const unsigned widest = unsigned(values.get_int("map_size")) / kMapPerFootprint;
        options.widest_texels = std::clamp(int(std::bit_floor(widest)), 2, kWidestFootprint);
    }
    return options;
}

gl::Defines prefilter_defines(const ParameterValues& values) {
    return {{"MIPMAPS", has_mipmaps(values) ? "1" : "0"}, {"ANISOTROPY", std::to_string(values.get_int("anisotropy"))}};
}

TechniqueNeeds prefilter_needs(const ParameterValues& values) {
    return map_needs_with_margin(values, find_margin_texels(prefilter_options(values)));
}

TruthSpec prefilter_truth(const ParameterValues& values) {
    const MomentMapOptions options = prefilter_options(values);
    const double variance = compute_blur_variance(options.radius, options.filter) + 1.0 / 12;
    return {.kind = TruthKind::Filtered, .footprint_texels = std::sqrt(12 * variance)};
}

void check_exponent(const std::string& technique, const std::string& parameter, const ParameterValues& values,
                    double most_16_bits) {
    const double exponent = values.get_float(parameter);
    if (!has_16_bits(values) || exponent <= most_16_bits) return;
    char text[80];
    std::snprintf(text, sizeof text, "a number from 0 to %g with bits = 16, where more overflows", most_16_bits);
    refuse_parameter(technique, parameter, exponent, text);
}

double choose_exponent(const ParameterValues& values, const std::string& parameter, double automatic_32_bits,
                       double automatic_16_bits) {
    const double exponent = values.get_float(parameter);
    return exponent > 0 ? exponent : has_16_bits(values) ? automatic_16_bits : automatic_32_bits;
}

}  // namespace shadow_layers
