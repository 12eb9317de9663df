// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Soft shadows as the mean of hard ones: the light's shape is sampled at N points, any technique for hard shadows
// answers for each, and the session averages the answers with the light that each point would bring. The option
// `light_samples` of that technique, with a name of its own. The soft reference where Blender is not at hand. Based on:
// T. Heidmann, Real shadows, real time, 1991, as described by M. Kenzel, Edge Distance Shadow Mapping, 2013,
// section 1.1.1. Differences: samples are weighted (cosines, and of an area light the distance), so that the ratio of
// light with and without shadows comes out, as from Cycles; patterns made for the count. Fails: N + 1 grey levels, seen
// as bands in wide penumbrae; bulbs that are large against their distance (lights/light_shape.h); what the hard
// technique gets wrong.
#include "techniques/multi/multi.h"

#include "techniques/common_parameters.h"
#include "techniques/inner_technique.h"
#include "techniques/light_samples_option.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {
namespace {

/// Those for hard shadows among all that are registered; not this one, whose description is being made.
std::vector<TechniqueDescriptor> describe_inner_techniques() {
    std::vector<TechniqueDescriptor> inner;
    for (const TechniqueEntry& entry : technique_entries()) {
        if (entry.describe == describe_multi) continue;
        TechniqueDescriptor d = entry.describe();
        if (!d.test_only && can_average_light_samples(d)) inner.push_back(std::move(d));
    }
    return inner;
}

/// The inner technique's own defaults, but for the size of maps.
ParameterValues inner_values(const ParameterValues& values) {
    const TechniqueDescriptor& inner = find_technique_descriptor(values.get_enum("technique"));
    ParameterValues given;
    for (const ParameterSpec& spec : inner.parameters)
        if (spec.id == "map_size") given.set("map_size", values.get_int("map_size"));
    return given;
}

class Multi final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        inner_.prepare(engine, parameters.get_enum("technique"), inner_values(parameters));
    }
    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        inner_.render(engine, task, outputs);
    }

private:
    InnerTechnique inner_;
};

ParameterSpec technique_parameter() {
    ParameterBuilder parameter = enum_parameter("technique", "Technique", "sm");
    parameter.help("What finds the hard shadow of each position, with its own defaults");
    for (const TechniqueDescriptor& inner : describe_inner_techniques())
        parameter.item(inner.id, inner.label, inner.summary);
    return parameter;
}

}  // namespace

TechniqueDescriptor describe_multi() {
    return {
        .id = "multi",
        .label = "Multi-Sample",
        .summary = "Soft shadows of the light's own shape: the mean of hard shadows from many positions on it",
        .reference = "Kenzel13, section 1.1.1",
        .limits = "As many grey levels as positions; the time grows with them",
        .parameters =
            {
                map_size_parameter(),
                int_parameter("positions", "Positions", 16)
                    .range(1, kMostLightSamples)
                    .help("Points on the light's shape, each with maps of its own; 1 is the hard shadow of its centre"),
                light_pattern_parameter("pattern", "Pattern"),
                technique_parameter(),
            },
        .light_size = LightSize::Followed,
        .needs =
            [](const ParameterValues& values) {
                TechniqueNeeds needs = find_inner_needs(values.get_enum("technique"), inner_values(values));
                needs.light_samples = int(values.get_int("positions"));
                needs.light_pattern = read_light_pattern(values, "pattern");
                return needs;
            },
        .truth = [](const ParameterValues&) { return TruthSpec{TruthKind::Soft}; },
        .check =
            [](const ParameterValues& values) {
                resolve_parameters(find_technique_descriptor(values.get_enum("technique")), inner_values(values));
            },
    };
}

std::unique_ptr<Technique> make_multi() { return std::make_unique<Multi>(); }

}  // namespace shadow_layers
