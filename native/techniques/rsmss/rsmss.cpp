// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Revectorisation-based shadow map silhouette smoothing: the border's line from step to step, with a ramp one texel
// wide.
//   1. the depth tests of a pixel's texel and its four neighbours: where they agree, that is the answer
//   2. elsewhere, on both sides of the border, the run of texels along the discontinuity is walked to both ends; the
//      pixel's distance from the line through the steps' middles, measured across the run, is its visibility
// Based on: [Macedo16] M. C. F. Macedo, A. L. Apolinario, Revectorization-based shadow mapping, Graphics Interface
// 2016, 3.1, 3.3 and supplement. Differences: the thirty-one cases of the supplement are one rule and, for channels a
// texel wide, the cases (docs/techniques/rsmss.md) or the sum of both walls' coverages; bends of channels are derived
// anew; texels that all four neighbours contradict are turned beforehand; texels are compared in the receiver's own
// plane. Fails: the ramp is as wide as the map's texels, whatever the light; between 30 and 60 degrees to the map's
// axes steps are only a texel long, and little is left to smooth them by.
#include "techniques/rsmss/rsmss.h"

#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"
#include "techniques/revectorisation_parameters.h"

namespace shadow_layers {
namespace {

constexpr double kRampTexels = 1;

class RSMSS final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        const bool paper = parameters.get_enum("channels") == "paper";
        pass_.prepare(engine, revectorise_settings(parameters, true), "techniques/rsmss/rsmss.frag",
                      {{"CHANNELS", paper ? "kChannelsPaper" : "kChannelsDisjoint"},
                       {"THRESHOLD", parameters.get_bool("threshold") ? "1" : "0"}});
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        outputs.set("visibility", pass_.run(engine, task.frame, task.light, task.sample));
    }

private:
    RevectorisePass pass_;
};

std::vector<ParameterSpec> rsmss_parameters() {
    return revectorisation_parameters({
        channels_parameter(),
        bool_parameter("threshold", "Threshold", false)
            .help("Cut the ramp at one half, for hard borders through the middles of the steps"),
    });
}

TruthSpec rsmss_truth(const ParameterValues& values) {
    if (values.get_bool("threshold")) return {};
    return {.kind = TruthKind::Filtered, .footprint_texels = kRampTexels};
}

}  // namespace

TechniqueDescriptor describe_rsmss() {
    return {
        .id = "rsmss",
        .label = "RSMSS",
        .summary =
            "Revectorised shadows with smoothed borders: a ramp one texel wide along lines instead of texel steps",
        .reference = "Macedo16, 3.3",
        .limits = "The ramp is a texel wide, whatever the light; borders at 30 to 60 degrees to the map stay stepped",
        .parameters = rsmss_parameters(),
        .needs = revectorisation_needs,
        .truth = rsmss_truth,
    };
}

std::unique_ptr<Technique> make_rsmss() { return std::make_unique<RSMSS>(); }

}  // namespace shadow_layers
