// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/revectorise.h"

#include "stages/depth_map.h"

namespace shadow_layers {
namespace {

constexpr double kReadsToDecide = 5;  // the texel and its neighbours
// Two runs, two directions, the texel and its sides: 16 for each step of a pixel that walks, as one in sixteen does.
constexpr double kReadsPerWalkStep = 1;

}  // namespace

gl::Defines RevectoriseSettings::defines() const { return {{"FOLLOW_SLOPE", follow_slope ? "1" : "0"}}; }

void RevectorisePass::prepare(Engine& engine, const RevectoriseSettings& settings, const std::string& walker,
                              gl::Defines defines) {
    settings_ = settings;
    gl::Defines decider_defines = settings.defines();
    decider_defines.emplace("EXITING", settings.exiting ? "1" : "0");
    decider_ = &engine.program("frame/fullscreen.vert", "stages/revectorise_decide.frag", decider_defines);
    defines.merge(settings.defines());
    walker_ = &engine.program("frame/fullscreen.vert", walker, defines);
}

const gl::Texture& RevectorisePass::run(Engine& engine, const Frame& frame, const Light& light,
                                        const LightSample& sample) {
    const auto map = render_depth_map(engine, *frame.scene, sample);
    return resolve_.run(engine, {.frame = frame,
                                 .light = light,
                                 .sample = sample,
                                 .program = *decider_,
                                 .second_program = walker_,
                                 .work_per_pixel = kReadsToDecide,
                                 .second_work_per_pixel = kReadsPerWalkStep * settings_.walk_limit,
                                 .bind_inputs = [&] { map->texture->bind(kDepthMapUnit); },
                                 .bind_second_inputs = [&] { walker_->set("u_walk_limit", settings_.walk_limit); }});
}

}  // namespace shadow_layers
