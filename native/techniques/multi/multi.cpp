// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Soft shadows as the mean of hard ones: the light's shape is sampled at N positions, any technique for hard shadows
// answers for each, and the answers are averaged with the light that each position would bring. The soft reference
// where Blender is not at hand. Based on: T. Heidmann, Real shadows, real time, 1991, as told by M. Kenzel, Edge
// Distance Shadow Mapping, 2013, section 1.1.1. Differences: positions are weighted (cosines, and of an area light the
// distance), so that the ratio of light with and without shadows comes out, as from Cycles; patterns made for the
// count. Fails: N + 1 grey levels, seen as bands in wide penumbrae; bulbs that are large against their distance
// (lights/light_shape.h); what the hard technique gets wrong.
#include "techniques/multi/multi.h"

#include <algorithm>

#include "engine/picture_target.h"
#include "stages/resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/inner_technique.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {
namespace {

// Finer steps than 1 / 256 are lost in pictures of 8 bits, and each position holds its views.
constexpr int kMostPositions = 256;

/// Those for hard shadows among all that are registered; not this one, whose description is being made.
std::vector<TechniqueDescriptor> describe_inner_techniques() {
    std::vector<TechniqueDescriptor> inner;
    for (const TechniqueEntry& entry : technique_entries()) {
        if (entry.describe == describe_multi) continue;
        TechniqueDescriptor d = entry.describe();
        if (!d.test_only && find_truth(d, resolve_parameters(d, {})).kind == TruthKind::Hard)
            inner.push_back(std::move(d));
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

LightPattern find_pattern(const std::string& id) {
    if (id == "spiral") return LightPattern::Spiral;
    if (id == "grid") return LightPattern::Grid;
    if (id == "random") return LightPattern::Random;
    return LightPattern::Sequence;
}

class Multi final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        inner_.prepare(engine, parameters.get_enum("technique"), inner_values(parameters));
        add_program_ = &engine.program("frame/fullscreen.vert", "techniques/multi/multi_add.frag");
        divide_program_ = &engine.program("frame/fullscreen.vert", "techniques/multi/multi_divide.frag");
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const std::vector<LightSample>& positions = task.positions;
        sums_.fit(engine, task.frame.width, task.frame.height, {GL_RG32F}, "weighted visibility");
        sums_.framebuffer().clear_color(0, 0, 0);
        engine.count("picture_bytes", std::int64_t(sums_.byte_size()));
        // All alike: a light without size.
        const std::size_t count = positions.front().is_same_place(positions.back()) ? 1 : positions.size();
        for (std::size_t i = 0; i < count; ++i) {
            engine.check_cancelled();
            const std::vector<LightSample> one(1, positions[i]);
            const gl::Texture& visibility =
                inner_.render(engine, {task.frame, task.frames, task.light, one, task.parameters});
            add_position(engine, task, positions[i], visibility);
            engine.limit_queue();  // or all positions' maps would be held until the last is drawn
        }
        engine.count("light_samples", std::int64_t(count));
        outputs.set("visibility", divide_sums(engine, task.frame));
    }

private:
    void add_position(Engine& engine, const LightTask& task, const LightSample& position,
                      const gl::Texture& visibility) {
        const auto timer = engine.time_stage("multi_add");
        if (!params_buf_) params_buf_ = gl::Buffer(engine.device(), sizeof(LightParams), "light params");
        const LightParams params = make_light_params(task.frame, task.light, position);
        params_buf_.write(&params, sizeof params);
        params_buf_.bind_base(GL_UNIFORM_BUFFER, kLightParamsSlot);
        add_program_->use();
        add_program_->set("u_is_area", task.light.kind == LightKind::Area ? 1 : 0);
        add_program_->set("u_centre_rel", glm::vec3(glm::dvec3(task.light.world_from_light[3]) - task.frame.origin_ws));
        task.frame.position_tx->bind(kPositionUnit);
        task.frame.normal_tx->bind(kNormalUnit);
        visibility.bind(kDepthMapUnit);
        sums_.framebuffer().bind();
        DrawState state;
        state.blend = true;
        engine.draw_fullscreen(state);
    }

    const gl::Texture& divide_sums(Engine& engine, const Frame& frame) {
        const auto timer = engine.time_stage("multi_divide");
        mean_.fit(engine, frame.width, frame.height, {GL_R32F}, "mean visibility");
        divide_program_->use();
        sums_.texture().bind(0);
        mean_.framebuffer().bind();
        engine.draw_fullscreen();
        return mean_.texture();
    }

    InnerTechnique inner_;
    const gl::Program* add_program_ = nullptr;
    const gl::Program* divide_program_ = nullptr;
    PictureTarget sums_, mean_;
    gl::Buffer params_buf_;
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
    TechniqueDescriptor d;
    d.id = "multi";
    d.label = "Multi-Sample";
    d.summary = "Soft shadows of the light's own shape: the mean of hard shadows from many positions on it";
    d.reference = "Kenzel13, section 1.1.1";
    d.parameters = {
        map_size_parameter(),
        int_parameter("positions", "Positions", 16)
            .range(1, kMostPositions)
            .help("Points on the light's shape, each with maps of its own; 1 is the hard shadow of its centre"),
        enum_parameter("pattern", "Pattern", "spiral")
            .help("How the points are spread over the shape")
            .item("spiral", "Spiral", "A lattice made for the number of points; a sunflower on discs")
            .item("sequence", "Sequence", "An additive sequence, even at any number of points")
            .item("grid", "Grid", "Middles of cells of equal area; straight borders show its rows as bands")
            .item("random", "Random", "Independent points, to see what evenness is worth"),
        technique_parameter(),
    };
    d.outputs = visibility_output();
    d.lights = all_light_kinds();
    d.light_size = LightSize::Followed;
    d.limits = "As many grey levels as positions; the time grows with them";
    d.needs = [](const ParameterValues& values) {
        TechniqueNeeds needs = find_inner_needs(values.get_enum("technique"), inner_values(values));
        needs.light_samples = int(values.get_int("positions"));
        needs.light_pattern = find_pattern(values.get_enum("pattern"));
        return needs;
    };
    d.truth = [](const ParameterValues&) { return TruthSpec{TruthKind::Soft}; };
    d.check = [](const ParameterValues& values) {
        resolve_parameters(find_technique_descriptor(values.get_enum("technique")), inner_values(values));
    };
    return d;
}

std::unique_ptr<Technique> make_multi() { return std::make_unique<Multi>(); }

}  // namespace shadow_layers
