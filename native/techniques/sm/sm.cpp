// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Standard shadow mapping: a depth map from the light, one depth test per receiver.
// Based on: L. Williams, Casting curved shadows on curved surfaces, SIGGRAPH 1978.
// Differences: the receiver is compared in its own plane at the texel's centre, and casters are pushed back by half
// their slope per texel, so that there is no bias to tune (docs/techniques/sm.md). Fails: steps of a texel at the
// shadow's border; casters thinner than a texel.
#include "techniques/sm/sm.h"

#include "stages/depth_map.h"
#include "stages/resolve.h"
#include "techniques/common_parameters.h"

namespace shadow_layers {
namespace {

class SM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues&) override {
        program_ = &engine.program("frame/fullscreen.vert", "techniques/sm/sm.frag");
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const LightSample& sample = task.sample;
        const auto map = render_depth_map(engine, *task.frame.scene, sample);
        outputs.set("visibility", resolve_.run(engine, {.frame = task.frame,
                                                        .light = task.light,
                                                        .sample = sample,
                                                        .program = *program_,
                                                        .bind_inputs = [&] { map->texture->bind(kDepthMapUnit); }}));
    }

private:
    const gl::Program* program_ = nullptr;
    ResolvePass resolve_;
};

}  // namespace

TechniqueDescriptor describe_sm() {
    return {
        .id = "sm",
        .label = "Shadow Map",
        .summary = "Standard shadow mapping: one depth test per pixel, without a bias to tune",
        .reference = "Williams78",
        .limits = "Borders are stepped by the map's texels; casters thinner than a texel break up",
        .parameters = {map_size_parameter()},
        .needs = map_needs,
    };
}

std::unique_ptr<Technique> make_sm() { return std::make_unique<SM>(); }

}  // namespace shadow_layers
