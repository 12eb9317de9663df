// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Extended shadow maps: quads along the silhouette edges put a distance of 8 bits and a depth into the texels beside
// them; the distance, interpolated between texels, draws a straight border, half a texel's diagonal outside of where
// it belongs, so that the steps of the depth map stay hidden within it.
// Based on: T. Bujnak, Extended shadow maps, CESCG 2004. Differences (docs/techniques/extsm.md): quads are made on the
// CPU in double and extended inside the caster as well; whether an edge is seen is asked of the depths round its foot;
// the attenuated light is a channel of its own. "forced" = the project's: depth tests in the receiver's plane give the
// sign, the map the distance, nothing is shifted. Fails: shadows are wider than they should be; two edges in a texel;
// gaps where quads of a convex corner part.
#include "techniques/extsm/extsm.h"

#include "light_params.h"
#include "stages/resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/extsm/extended_shadow_map.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {
namespace {

/// "Depth biasing" is all that the paper says of its comparison: the receiver is compared at its own depth with casters
/// that are pushed back by two texels' worth of their slope, as in edsm's "thesis".
constexpr double kPaperSlopeFactor = 2.0;

bool is_forced(const ParameterValues& values) { return values.get_enum("reading") == "forced"; }
bool is_attenuated(const ParameterValues& values) { return values.get_enum("attenuation") != "none"; }

ExtendedMapOptions map_options(const ParameterValues& values) {
    ExtendedMapOptions options;
    options.farthest_edge = values.get_enum("overlap") == "max";
    options.forced = is_forced(values);
    options.guard_zone = values.get_float("guard_zone");
    return options;
}

class ExtSM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        program_ =
            &engine.program("frame/fullscreen.vert", is_forced(parameters) ? "techniques/extsm/extsm_forced.frag"
                                                                           : "techniques/extsm/extsm_paper.frag");
        attenuation_program_ = nullptr;
        if (!is_attenuated(parameters)) return;
        const bool linear = parameters.get_enum("attenuation") == "linear";
        attenuation_program_ = &engine.program("frame/fullscreen.vert", "techniques/extsm/extsm_attenuation.frag",
                                               {{"ATTENUATION", linear ? "1" : "2"}});
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const LightSample& sample = task.sample;
        const Scene& scene = *task.frame.scene;
        const ExtendedMapOptions options = map_options(task.parameters);
        const auto depth_map =
            render_depth_map(engine, scene, sample, options.forced ? kReceiverPlaneSlopeFactor : kPaperSlopeFactor);
        const auto edge_map = render_extended_shadow_map(engine, scene, sample, *depth_map, options);
        const auto bind = [&] {
            depth_map->texture->bind(kDepthMapUnit);
            edge_map->values->bind(kEdgeMapUnit);
            edge_map->depths->bind(kEdgeDepthUnit);
            program_->set("u_depth_sign", options.depth_sign());
            if (options.forced) program_->set("u_half_width_texels", float(options.half_width_texels()));
        };
        const gl::Texture& visibility = resolve_.run(engine, {.frame = task.frame,
                                                              .light = task.light,
                                                              .sample = sample,
                                                              .program = *program_,
                                                              .work_per_pixel = options.forced ? 6.0 : 3.0,
                                                              .bind_inputs = bind});
        outputs.set("visibility", visibility);
        outputs.set("intensity", attenuation_program_ ? attenuate(engine, task, visibility) : visibility);
    }

private:
    const gl::Texture& attenuate(Engine& engine, const LightTask& task, const gl::Texture& visibility) {
        const auto bind = [&] {
            visibility.bind(kDepthMapUnit);
            attenuation_program_->set("u_range", float(task.parameters.get_float("range")));
        };
        return attenuation_.run(engine, {.frame = task.frame,
                                         .light = task.light,
                                         .sample = task.sample,
                                         .program = *attenuation_program_,
                                         .bind_inputs = bind});
    }

    const gl::Program* program_ = nullptr;
    const gl::Program* attenuation_program_ = nullptr;
    ResolvePass resolve_, attenuation_;
};

std::vector<ParameterSpec> extsm_parameters() {
    return {
        map_size_parameter(),
        enum_parameter("reading", "Reading", "forced")
            .help("How depth tests and edges are put together")
            .item("paper", "Paper", "The depth test or the interpolated edge darkens; borders lie 0.7 texels outside")
            .item("forced", "Forced", "Depth tests in the receiver's plane give the sign, the map the distance"),
        enum_parameter("overlap", "Overlap", "max")
            .help("Which depth a texel keeps of several edges; of their distances it keeps the smallest")
            .item("max", "Maximum Depth", "The farthest: near a crossing borders are those of the shadow map")
            .item("min", "Minimum Depth", "The nearest: near a crossing shadows widen"),
        float_parameter("guard_zone", "Guard Zone", 0.25)
            .range(0, 0.33)
            .help("Part of an edge's quad, from its inner end on, over which its distance stays the same; paper only"),
        enum_parameter("attenuation", "Attenuation", "none")
            .help("How the channel 'intensity' falls off with the distance to the light; a sun's never does")
            .item("none", "None", "Intensity equals visibility")
            .item("linear", "Linear", "One minus the distance over the range")
            .item("quadratic", "Quadratic", "One minus the square of the distance over the range"),
        float_parameter("range", "Range", 10)
            .range(0.001, 1e6)
            .unit("m")
            .help("Distance at which an attenuated light ends"),
    };
}

}  // namespace

TechniqueDescriptor describe_extsm() {
    return {
        .id = "extsm",
        .label = "Extended Map",
        .summary =
            "Extended shadow maps: quads along silhouette edges store distances of 8 bits that straighten borders",
        .reference = "Bujnak04",
        .limits = "As the paper reads, shadows are most of a texel too wide; where edges cross in a texel, one is lost",
        .parameters = extsm_parameters(),
        .outputs = {describe_visibility(),
                    {"intensity", "Intensity", 1, "Visibility times the attenuation with distance"}},
        .meshes = CasterMeshes::MeshEdges,
        .needs = map_needs,
    };
}

std::unique_ptr<Technique> make_extsm() { return std::make_unique<ExtSM>(); }

}  // namespace shadow_layers
