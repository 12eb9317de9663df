// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow silhouette maps: beside the depth map a map with a point of the silhouette in every cell; where the four depth
// tests round a receiver disagree, spokes between neighbouring points say which of them to believe.
// Based on: P. Sen, M. Cammarano, P. Hanrahan, Shadow silhouette maps, SIGGRAPH 2003, as described in M. Kenzel, Edge
// Distance Shadow Mapping, 2013, 2.2. Differences: points come from edges that are cut to each cell in the shader, an
// edge's end in a cell is kept; depth tests as in sm, per corner in the receiver's plane. Fails: two silhouettes in a
// cell (the last one drawn is kept); features smaller than a texel.
#include "techniques/sssm/sssm.h"

#include "stages/resolve.h"
#include "techniques/common_parameters.h"
#include "techniques/sssm/silhouette_map.h"

namespace shadow_layers {
namespace {

class SSSM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues&) override {
        program_ = &engine.program("frame/fullscreen.vert", "techniques/sssm/sssm.frag");
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const LightSample& sample = task.sample;
        const Scene& scene = *task.frame.scene;
        const auto depth_map = render_depth_map(engine, scene, sample);
        const auto silhouette_map = render_silhouette_map(engine, scene, sample, *depth_map);
        const auto bind = [&] {
            depth_map->texture->bind(kDepthMapUnit);
            silhouette_map->texture->bind(kEdgeMapUnit);
        };
        outputs.set("visibility", resolve_.run(engine, {.frame = task.frame,
                                                        .light = task.light,
                                                        .sample = sample,
                                                        .program = *program_,
                                                        .work_per_pixel = 9,
                                                        .bind_inputs = bind}));
    }

private:
    const gl::Program* program_ = nullptr;
    ResolvePass resolve_;
};

}  // namespace

TechniqueDescriptor describe_sssm() {
    return {
        .id = "sssm",
        .label = "Silhouette Map",
        .summary = "Shadow silhouette maps: a point of the silhouette per texel bends the border to where it belongs",
        .reference = "Sen03",
        .limits = "One point per texel: where two silhouettes cross a texel, one of them is lost",
        .parameters = {map_size_parameter()},
        .meshes = CasterMeshes::MeshEdges,
        .needs = map_needs,
    };
}

std::unique_ptr<Technique> make_sssm() { return std::make_unique<SSSM>(); }

}  // namespace shadow_layers
