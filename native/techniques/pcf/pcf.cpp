// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Percentage-closer filtering: the mean of k x k depth tests.
// Based on: W. T. Reeves, D. H. Salesin, R. L. Cook, Rendering antialiased shadows with depth maps, SIGGRAPH 1987.
// Differences: a regular grid of taps; every tap is compared in the receiver's own plane; pixels whose taps all agree
// for sure are found by a range map, without taps (docs/techniques/pcf.md).
// Fails: the border's width follows the map's texels, not the light's size; wide kernels smear contacts.
#include "techniques/pcf/pcf.h"

#include <cmath>

#include "stages/depth_map.h"
#include "stages/depth_range_map.h"
#include "stages/resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {
namespace {

/// Texels between taps. A kernel of one tap has no extent, whatever the radius.
double tap_spacing(const ParameterValues& values) {
    const auto kernel = values.get_int("kernel");
    const double radius = values.get_float("radius");
    return kernel > 1 && radius > 0 ? 2.0 * radius / double(kernel - 1) : 1.0;
}

double kernel_radius(const ParameterValues& values) {
    return 0.5 * double(values.get_int("kernel") - 1) * tap_spacing(values);
}

/// How far a tap's texels lie from the receiver's own.
int window_radius(const ParameterValues& values) {
    return int(std::ceil(kernel_radius(values) + (values.get_bool("bilinear") ? 0.5 : 0.0)));
}

class PCF final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        program_ = &engine.program("frame/fullscreen.vert", "techniques/pcf/pcf.frag",
                                   {{"KERNEL", std::to_string(parameters.get_int("kernel"))},
                                    {"BILINEAR", parameters.get_bool("bilinear") ? "1" : "0"},
                                    {"EARLY_OUT", parameters.get_bool("early_out") ? "1" : "0"}});
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const LightSample& sample = task.sample;
        const double kernel = double(task.parameters.get_int("kernel"));
        const auto map = render_depth_map(engine, *task.frame.scene, sample);
        const int radius = window_radius(task.parameters);
        const auto ranges =
            task.parameters.get_bool("early_out") ? render_depth_range_map(engine, *map, radius) : nullptr;
        const auto bind = [&] {
            map->texture->bind(kDepthMapUnit);
            if (ranges) ranges->bind();
            program_->set("u_radius_texels", float(radius));
            program_->set("u_spacing_texels", float(tap_spacing(task.parameters)));
        };
        outputs.set(
            "visibility",
            resolve_.run(engine, {.frame = task.frame,
                                  .light = task.light,
                                  .sample = sample,
                                  .program = *program_,
                                  .work_per_pixel = kernel * kernel * (task.parameters.get_bool("bilinear") ? 4 : 1),
                                  .bind_inputs = bind}));
    }

private:
    const gl::Program* program_ = nullptr;
    ResolvePass resolve_;
};

std::vector<ParameterSpec> pcf_parameters() {
    return {
        map_size_parameter(),
        int_parameter("kernel", "Kernel", 3)
            .range(1, 31)
            .unit("taps")
            .help("Depth tests per side of the square kernel; 1 is the standard shadow map"),
        float_parameter("radius", "Radius", 0)
            .range(0, 64)
            .unit("texels")
            .help("Distance from the middle to the outermost taps; 0 sets the taps one texel apart"),
        bool_parameter("bilinear", "Bilinear", false)
            .help("Weigh the four texels round each tap, which makes the border's steps a ramp"),
        bool_parameter("early_out", "Early Out", true)
            .help(
                "Skip the taps of pixels whose depth tests all agree for sure; off: test each tap of each pixel, which "
                "gives the same picture"),
    };
}

/// The square that the taps' texels cover.
TruthSpec pcf_truth(const ParameterValues& values) {
    const double side = 1 + 2 * kernel_radius(values) + (values.get_bool("bilinear") ? 1 : 0);
    return {.kind = TruthKind::Filtered, .footprint_texels = side};
}

}  // namespace

TechniqueDescriptor describe_pcf() {
    return {
        .id = "pcf",
        .label = "PCF",
        .summary = "Percentage-closer filtering: the mean of k x k depth tests, for softened borders",
        .reference = "Reeves87",
        .limits = "The border's width follows the map's texels, not the light's size",
        .parameters = pcf_parameters(),
        .needs = [](const ParameterValues& values) { return map_needs_with_margin(values, window_radius(values)); },
        .truth = pcf_truth,
    };
}

std::unique_ptr<Technique> make_pcf() { return std::make_unique<PCF>(); }

}  // namespace shadow_layers
