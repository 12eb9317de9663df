// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Single-pass shadow map silhouette revectorisation: a shadow map whose border runs in straight lines from step to step
// instead of along the texels.
//   1. the depth tests of a pixel's texel and its four neighbours: where they agree, that is the answer
//   2. elsewhere the run of texels along the discontinuity is walked to both ends, and the pixel's place against the
//      line from end to end decides
// Based on: [Macedo16] M. C. F. Macedo, A. L. Apolinario, Revectorization-based shadow mapping, Graphics Interface
// 2016, 3.1, 3.2 and supplement; after [Bondarev14]. Differences: the twelve cases of the supplement are one rule
// (docs/techniques/smsr.md; equal by test); texels are compared in the receiver's own plane, instead of with one depth
// and a constant epsilon; the first step is a program of its own. Fails: the border is half a texel too dark (mode
// "half" is not); details of a texel vanish or turn to points.
#include "techniques/smsr/smsr.h"

#include "techniques/common_parameters.h"
#include "techniques/revectorisation_parameters.h"

namespace shadow_layers {
namespace {

class SMSR final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        pass_.prepare(engine, revectorise_settings(parameters, hard_border_is_exiting(parameters)),
                      "techniques/smsr/smsr.frag", {{"VISIBILITY_OF", hard_border_function(parameters)}});
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        outputs.set("visibility", pass_.run(engine, task.frame, task.light, task.sample));
    }

private:
    RevectorisePass pass_;
};

}  // namespace

TechniqueDescriptor describe_smsr() {
    return {
        .id = "smsr",
        .label = "SMSR",
        .summary =
            "Shadow map silhouette revectorisation: hard shadows whose borders run in lines instead of texel steps",
        .reference = "Macedo16, 3.2",
        .limits =
            "Borders are half a texel too dark, but in mode half; details of a texel's size vanish or turn to points",
        .parameters = revectorisation_parameters({hard_border_parameter()}),
        .needs = revectorisation_needs,
    };
}

std::unique_ptr<Technique> make_smsr() { return std::make_unique<SMSR>(); }

}  // namespace shadow_layers
