// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/resolve.h"

#include <glm/gtc/matrix_transform.hpp>

#include "engine/banded_draw.h"
#include "shadow_layers/error.h"

namespace shadow_layers {

std::span<const LightView> get_shader_views(const LightSample& sample) {
    if (sample.views.size() > std::size_t(kMaxViews))
        throw Error("a light sample has " + std::to_string(sample.views.size()) + " views; shaders have room for " +
                    std::to_string(kMaxViews) + " (kMaxViews in shaders/shared/light_params.h)");
    return sample.views;
}

LightParams make_light_params(const Frame& frame, const Light& light, const LightSample& sample) {
    LightParams params{};
    const glm::dmat4 ws_from_rel = glm::translate(glm::dmat4(1.0), frame.origin_ws);
    const auto views = get_shader_views(sample);
    for (std::size_t layer = 0; layer < views.size(); ++layer)
        params.lc_from_rel[layer] = glm::mat4(views[layer].lc_from_ws * ws_from_rel);
    // Along the axes the difference to a far light is taken in double: what lies across the axis of a narrow cone is
    // small.
    const glm::dvec3 place_rel = sample.position_ws - frame.origin_ws;
    for (int axis = 0; axis < 3; ++axis)
        params.axes_rel[axis] = glm::vec4(glm::dvec4(sample.axes_ws[axis], glm::dot(sample.axes_ws[axis], place_rel)));
    params.place_rel =
        sample.directional ? glm::vec4(glm::vec3(sample.to_light_ws), 0.0f) : glm::vec4(glm::vec3(place_rel), 1.0f);
    params.cone = glm::vec4(float(sample.cone_cos), float(sample.cone_sin), float(1 / sample.cone_scale.x),
                            float(1 / sample.cone_scale.y));
    params.view_choice = sample.choice;
    if (!sample.views.empty()) {
        const LightView& view = sample.views.front();
        params.map =
            glm::vec4(float(view.size_texels), 1.0f / float(view.size_texels), float(view.border_texels), 0.0f);
    } else {
        params.map = glm::vec4(1.0f, 1.0f, 0.0f, 0.0f);
    }
    params.receivers = glm::uvec4(std::uint32_t(light.receiver_set), std::uint32_t(light.receiver_set >> 32),
                                  light.casts_shadow ? 1u : 0u, 0u);
    return params;
}

const gl::Texture& ResolvePass::run(Engine& engine, const Task& task) {
    const auto timer = engine.time_stage("resolve");
    const Frame& frame = task.frame;
    std::vector<GLenum> formats{task.format};
    if (task.second_program) formats.push_back(GL_DEPTH_COMPONENT32F);  // which pixels are decided
    target_.fit(engine, frame.width, frame.height, formats, "resolved layer");
    if (task.second_program) engine.count("picture_bytes", std::int64_t(target_.texture(1).byte_size()));
    if (!params_buf_) params_buf_ = gl::Buffer(engine.device(), sizeof(LightParams), "light params");
    const LightParams params = make_light_params(frame, task.light, task.sample);
    params_buf_.write(&params, sizeof params);

    task.program.use();
    if (task.bind_inputs) task.bind_inputs();
    frame.position_tx->bind(kPositionUnit);
    frame.normal_tx->bind(kNormalUnit);
    params_buf_.bind_base(GL_UNIFORM_BUFFER, kLightParamsSlot);
    target_.framebuffer().bind();

    // What the first program decides goes before the cleared depth, where the second one's pixels don't reach.
    DrawState state;
    if (task.second_program) {
        target_.framebuffer().clear_depth();
        state = DrawState::nearest();
    }
    draw_fullscreen_in_bands(engine, frame.width, frame.height, task.work_per_pixel, state);
    if (task.second_program) {
        task.second_program->use();
        if (task.bind_second_inputs) task.bind_second_inputs();
        state.depth_write = false;
        draw_fullscreen_in_bands(engine, frame.width, frame.height, task.second_work_per_pixel, state);
    }
    return target_.texture();
}

}  // namespace shadow_layers
