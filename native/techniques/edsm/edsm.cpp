// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Edge distance shadow mapping: beside the depth map a map of distances to silhouette edges; where the four depth tests
// round a receiver disagree, the edge decides. Based on: M. Kenzel, Edge Distance Shadow Mapping, master's thesis, TU
// Graz 2013, chapters 3 and 4, figure 6.1. Differences (docs/techniques/edsm.md says what each is worth): a depth
// reference per texel in the receiver's plane; the tests give the sign and the map only the distance, or a whole line
// if it agrees with all tests; edges that lie behind the receiver or inside a solid don't count; a derived order of
// edges. "reading" = thesis has none of them. Fails: two edges within a texel; features smaller than a texel, where no
// test disagrees.
#include "techniques/edsm/edsm.h"

#include <cmath>

#include "stages/resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/edsm/edge_distance_map.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {
namespace {

const double kFootprintDiagonal = std::sqrt(2.0);
constexpr double kThesisSlopeFactor = 2.0;

bool is_thesis(const ParameterValues& values) { return values.get_enum("reading") == "thesis"; }

EdgeOrder edge_order(const std::string& id) {
    if (id == "stream") return EdgeOrder::Stream;
    if (id == "min") return EdgeOrder::Min;
    if (id == "thesis") return EdgeOrder::Thesis;
    return EdgeOrder::Corrected;
}

class EDSM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        if (is_thesis(parameters)) {
            program_ = &engine.program("frame/fullscreen.vert", "techniques/edsm/edsm_thesis.frag");
        } else {
            const bool soft = parameters.get_float("softness") > 0;
            program_ =
                &engine.program("frame/fullscreen.vert", "techniques/edsm/edsm.frag", {{"SOFT", soft ? "1" : "0"}});
        }
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const LightSample& sample = task.sample;
        const Scene& scene = *task.frame.scene;
        const EdgeDistanceOptions options = edsm_edge_options(task.parameters);
        const double slope = is_thesis(task.parameters) ? kThesisSlopeFactor : kReceiverPlaneSlopeFactor;
        const auto depth_map = render_depth_map(engine, scene, sample, slope);
        const auto edge_map = render_edge_distance_map(engine, scene, sample, *depth_map, options);
        const auto bind = [&] {
            depth_map->texture->bind(kDepthMapUnit);
            edge_map->texture->bind(kEdgeMapUnit);
            program_->set("u_softness_texels", float(task.parameters.get_float("softness")));
            if (!is_thesis(task.parameters)) program_->set("u_missing_texels", float(options.edges.half_width_texels));
        };
        outputs.set("visibility", resolve_.run(engine, {.frame = task.frame,
                                                        .light = task.light,
                                                        .sample = sample,
                                                        .program = *program_,
                                                        .work_per_pixel = 8,
                                                        .bind_inputs = bind}));
    }

private:
    const gl::Program* program_ = nullptr;
    ResolvePass resolve_;
};

std::vector<ParameterSpec> edsm_parameters() {
    return {
        map_size_parameter(),
        float_parameter("softness", "Softness", 0)
            .range(0, 16)
            .unit("texels")
            .help("Width of the border's ramp, as of a round light; 0 gives hard shadows"),
        enum_parameter("reading", "Reading", "improved")
            .help("How tests and distances are put together")
            .item("improved", "Improved", "Depth tests give the sign, the map the distance or a whole line")
            .item("thesis", "Thesis", "As the thesis reads: one slope bias, interpolated signed distances"),
        enum_parameter("edge_order", "Edge Order", "corrected")
            .help("Which of several edges a texel keeps")
            .item("stream", "Stream", "The one drawn last (figure 3.6)")
            .item("min", "Minimum", "The smallest distance to the edge's line (figure 3.7)")
            .item("thesis", "Thesis", "The thesis's corner priority (equation 3.8)")
            .item("corrected", "Corrected", "The nearest segment, then the more orthogonal one"),
        enum_parameter("quads", "Edge Quads", "post_projective")
            .help("Where the width of an edge's quad is measured (5.2.1)")
            .item("post_projective", "Post-Projective", "In the map: the same number of texels everywhere")
            .item("perspective", "Perspective", "Before projection: far edges get fewer texels"),
    };
}

}  // namespace

EdgeDistanceOptions edsm_edge_options(const ParameterValues& values) {
    const bool thesis = is_thesis(values);
    EdgeDistanceOptions options;
    options.order = edge_order(values.get_enum("edge_order"));
    options.own_texel_test = thesis;
    options.edges.silhouettes.skip_concave = !thesis;
    options.edges.silhouettes.skip_two_sided = !thesis;
    options.edges.foreshortened = values.get_enum("quads") == "perspective";
    // An edge matters to texels whose 2 x 2 footprint it crosses, and as far as the soft kernel looks.
    options.edges.half_width_texels = (thesis ? 1.0 : kFootprintDiagonal) + 0.5 * values.get_float("softness");
    return options;
}

TechniqueDescriptor describe_edsm() {
    return {
        .id = "edsm",
        .label = "EDSM",
        .summary =
            "Edge distance shadow mapping: hard borders rebuilt from silhouette edges, finer than the map's texels",
        .reference = "Kenzel13, chapters 3 and 4",
        .limits =
            "Where two edges fall into one texel, or a caster is thinner than one, it is no better than the shadow map",
        .parameters = edsm_parameters(),
        .meshes = CasterMeshes::MeshEdges,
        .needs =
            [](const ParameterValues& values) {
                // The soft kernel sees edges as far as their quads reach, and asks the map beside them.
                const bool soft = values.get_float("softness") > 0;
                return map_needs_with_margin(
                    values, soft ? int(std::ceil(edsm_edge_options(values).edges.half_width_texels)) : 0);
            },
    };
}

std::unique_ptr<Technique> make_edsm() { return std::make_unique<EDSM>(); }

}  // namespace shadow_layers
