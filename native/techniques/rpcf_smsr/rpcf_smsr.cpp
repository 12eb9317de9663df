// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Revectorised percentage-closer filtering over hard borders: the mean of k x k revectorised visibilities, each of the
// same sample moved by whole texels.
// Based on: M. C. F. Macedo, A. L. Apolinario, Revectorization-based shadow mapping, Graphics Interface 2016, 3.4,
// Eq. 2. Differences: every tap is compared in the receiver's own plane; taps are not evaluated one by one but as runs
// of a bit pattern, with the same result (docs/techniques/rpcf_smsr.md); kernels may have an even number of taps.
// Fails: shadows grow by half a texel, as those of smsr do; wide kernels smear contacts as pcf's do.
#include "techniques/rpcf_smsr/rpcf_smsr.h"

#include "stages/revectorised_filter.h"
#include "techniques/common_parameters.h"
#include "techniques/revectorised_filter_parameters.h"

namespace shadow_layers {
namespace {

class RPCFOfSMSR final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        filter_.prepare(engine, revectorised_filter_settings(parameters));
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        outputs.set("visibility", filter_.run(engine, task.frame, task.light, task.sample));
    }

private:
    RevectorisedFilterPass filter_;
};

}  // namespace

TechniqueDescriptor describe_rpcf_smsr() {
    return {
        .id = "rpcf_smsr",
        .label = "RPCF + SMSR",
        .summary = "Revectorised percentage-closer filtering: the mean of k x k hard revectorised shadows",
        .reference = "Macedo16, section 3.4",
        .limits = "Shadows are half a texel too large; a small kernel shows bands",
        .parameters = revectorised_filter_parameters({}),
        .needs =
            [](const ParameterValues& values) {
                return map_needs_with_margin(values, revectorised_filter_settings(values).margin_texels());
            },
        .truth = revectorised_filter_truth,
    };
}

std::unique_ptr<Technique> make_rpcf_smsr() { return std::make_unique<RPCFOfSMSR>(); }

}  // namespace shadow_layers
