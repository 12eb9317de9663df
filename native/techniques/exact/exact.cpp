// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exact hard shadows at the price of a shadow map. The map is turned inside out: not depths are kept per texel and
// asked by receivers, but receivers are kept per tile, and every triangle is tested against those that it may shadow,
// in float with a bound of its error; what float can't decide is settled in double. Based on: T. Aila, S. Laine,
// Alias-free shadow maps, EGSR 2004 (receivers sorted by the light's view); the rest is this project's. Differences: on
// the CPU, with tiles instead of a hierarchy; no bias (visibility/occlusion_rule.h). Fails: nothing known, but for
// time: casters seen edge-on and long thin ones touch many tiles.
#include "techniques/exact/exact.h"

#include "techniques/common_parameters.h"
#include "visibility/exact_visibility.h"

namespace shadow_layers {
namespace {

class Exact final : public Technique {
public:
    void prepare(Engine&, const ParameterValues&) override {}

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const auto& visible =
            visibility_.compute(engine, task.frame, task.light, task.sample, int(task.parameters.get_int("map_size")));
        Image image{task.frame.width, task.frame.height, 1, std::vector<float>(visible.begin(), visible.end())};
        outputs.set("visibility", std::move(image));
    }

private:
    ExactVisibility visibility_;
};

}  // namespace

TechniqueDescriptor describe_exact() {
    return {
        .id = "exact",
        .label = "Exact",
        .summary = "Exact hard shadows: every receiver is tested against the triangles that may shadow it",
        .reference = "Aila04",
        .limits = "Long thin casters over many receivers cost time",
        // Here the size bounds the tiles that receivers are sorted into; it changes the time, never the picture.
        .parameters = {map_size_parameter()},
        .needs = map_needs,
    };
}

std::unique_ptr<Technique> make_exact() { return std::make_unique<Exact>(); }

}  // namespace shadow_layers
