// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Revectorised percentage-closer filtering over smooth borders: the mean of k x k visibilities of rsmss, each of the
// same sample moved by whole texels.
// Based on: M. C. F. Macedo, A. L. Apolinario, Revectorization-based shadow mapping, Graphics Interface 2016, 3.4,
// Eq. 3. Differences: every tap is compared in the receiver's own plane; taps are not evaluated one by one but as runs
// of a bit pattern, with the same result (docs/techniques/rpcf_rsmss.md); kernels may have an even number of taps.
// Fails: wide kernels smear contacts as pcf's do; the border's width follows the map's texels.
#include "techniques/rpcf_rsmss/rpcf_rsmss.h"

#include "stages/revectorised_filter.h"
#include "techniques/common_parameters.h"
#include "techniques/revectorisation_parameters.h"
#include "techniques/revectorised_filter_parameters.h"

namespace shadow_layers {
namespace {

RevectorisedFilterSettings read_settings(const ParameterValues& values) {
    RevectorisedFilterSettings settings = revectorised_filter_settings(values);
    settings.smooth = true;
    settings.cases_of_paper = values.get_enum("channels") == "paper";
    return settings;
}

class RPCFOfRSMSS final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        filter_.prepare(engine, read_settings(parameters));
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        outputs.set("visibility", filter_.run(engine, task.frame, task.light, task.sample));
    }

private:
    RevectorisedFilterPass filter_;
};

}  // namespace

TechniqueDescriptor describe_rpcf_rsmss() {
    return {
        .id = "rpcf_rsmss",
        .label = "RPCF + RSMSS",
        .summary = "Revectorised percentage-closer filtering: the mean of k x k smoothed revectorised shadows",
        .reference = "Macedo16, section 3.4",
        .limits = "The border's width follows the map's texels, not the light's size",
        .parameters = revectorised_filter_parameters({channels_parameter()}),
        .needs =
            [](const ParameterValues& values) {
                return map_needs_with_margin(values, read_settings(values).margin_texels());
            },
        .truth = revectorised_filter_truth,
    };
}

std::unique_ptr<Technique> make_rpcf_rsmss() { return std::make_unique<RPCFOfRSMSS>(); }

}  // namespace shadow_layers
