// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/light_mean.h"

#include "stages/resolve.h"

namespace shadow_layers {

void LightMean::begin(Engine& engine, const Frame& frame) {
    sums_.fit(engine, frame.width, frame.height, {GL_RG32F}, "weighted visibility");
    sums_.framebuffer().clear_color(0, 0, 0);
    engine.count("picture_bytes", std::int64_t(sums_.byte_size()));
}

void LightMean::add(Engine& engine, const Frame& frame, const Light& light, const LightSample& sample,
                    const gl::Texture& visibility) {
    const auto timer = engine.time_stage("light_mean_add");
    if (!params_buf_) params_buf_ = gl::Buffer(engine.device(), sizeof(LightParams), "light params");
    const LightParams params = make_light_params(frame, light, sample);
    params_buf_.write(&params, sizeof params);
    params_buf_.bind_base(GL_UNIFORM_BUFFER, kLightParamsSlot);
    const gl::Program& program = engine.program("frame/fullscreen.vert", "stages/light_mean_add.frag");
    program.use();
    program.set("u_is_area", light.kind == LightKind::Area ? 1 : 0);
    program.set("u_centre_rel", glm::vec3(glm::dvec3(light.world_from_light[3]) - frame.origin_ws));
    frame.position_tx->bind(kPositionUnit);
    frame.normal_tx->bind(kNormalUnit);
    visibility.bind(kDepthMapUnit);
    sums_.framebuffer().bind();
    DrawState state;
    state.blend = true;
    engine.draw_fullscreen(state);
}

const gl::Texture& LightMean::finish(Engine& engine, const Frame& frame) {
    const auto timer = engine.time_stage("light_mean_divide");
    mean_.fit(engine, frame.width, frame.height, {GL_R32F}, "mean visibility");
    engine.program("frame/fullscreen.vert", "stages/light_mean_divide.frag").use();
    sums_.texture().bind(0);
    mean_.framebuffer().bind();
    engine.draw_fullscreen();
    return mean_.texture();
}

}  // namespace shadow_layers
