// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exact soft shadows of the light's own shape: the same bits as rays from every receiver to the same samples of the
// light, for one traversal of a tree of the casters for each receiver and all its samples.
// Based on: E. Sintorn, E. Eisemann, U. Assarsson, Sample based visibility for soft shadows using alias-free shadow
// maps, EGSR 2008 (bit masks of light samples). Differences: pulled by receivers through a tree of boxes, which the
// masks of samples cull, instead of pushed by triangles; on the CPU; no bias (visibility/occlusion_rule.h); exact at
// ties. Fails: nothing known, but for time: fine casters everywhere before a light as large as the scene.
#include "techniques/soft/soft.h"

#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"
#include "visibility/soft_visibility.h"

namespace shadow_layers {
namespace {

constexpr int kMostLightSamples = 1024;

class Soft final : public Technique {
public:
    void prepare(Engine&, const ParameterValues&) override {}

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        SoftSettings settings;
        settings.light_samples = int(task.parameters.get_int("light_samples"));
        settings.is_rotated = task.parameters.get_enum("pattern") == "rotated";
        settings.picture_sample = task.picture_sample;
        outputs.set("visibility", Image{task.frame.width, task.frame.height, 1,
                                        compute_soft_visibility(engine, task.frame, task.light, settings)});
    }
};

}  // namespace

TechniqueDescriptor describe_soft() {
    return {
        .id = "soft",
        .label = "Exact Soft",
        .summary = "Exact soft shadows of the light's own shape, from fixed samples of it",
        .reference = "Sintorn08",
        .limits = "Fine casters before a light as large as the scene cost time",
        .parameters =
            {
                int_parameter("light_samples", "Light Samples", 64)
                    .range(1, kMostLightSamples)
                    .help("Points on the light's shape that each receiver asks; 1 is the hard shadow of its centre"),
                enum_parameter("pattern", "Pattern", "fixed")
                    .help("Whether all pixels ask the same points")
                    .item("fixed", "Fixed", "The same for all pixels: few samples show as bands")
                    .item("rotated", "Rotated", "Sixteen patterns over each 4 x 4 pixels: few samples show as noise"),
            },
        .light_size = LightSize::Followed,
        .needs =
            [](const ParameterValues& values) {
                TechniqueNeeds needs;
                needs.light_samples = int(values.get_int("light_samples"));
                needs.light_pattern = LightPattern::Spiral;
                needs.samples_itself = true;
                needs.shifts_samples = values.get_enum("pattern") == "rotated";
                return needs;
            },
        .truth = [](const ParameterValues&) { return TruthSpec{TruthKind::Soft}; },
    };
}

std::unique_ptr<Technique> make_soft() { return std::make_unique<Soft>(); }

}  // namespace shadow_layers
