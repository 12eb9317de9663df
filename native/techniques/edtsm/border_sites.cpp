// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/edtsm/border_sites.h"

#include <bit>
#include <cmath>
#include <optional>

#include "gl/sampler.h"
#include "lights/light_shape.h"
#include "stages/resolve.h"
#include "techniques/edtsm/pixel_camera_params.h"

namespace shadow_layers {
namespace {

constexpr float kDiscShape = 0, kSquareShape = 1;  // shaders/techniques/edtsm/light_cut_lib.glsl
constexpr double kWidestSun = 3.0;                 // radians; a half sky
constexpr double kReadsPerSite = 45;               // of five receivers, and of the map round one of them

double sun_radius(const Light& light) { return std::tan(0.5 * std::min(light.sun_angle, kWidestSun)); }

template <class T>
void write_block(Engine& engine, gl::Buffer& buffer, const T& block, GLuint slot, const char* label) {
    if (!buffer) buffer = gl::Buffer(engine.device(), sizeof(T), label);
    buffer.write(&block, sizeof(T));
    buffer.bind_base(GL_UNIFORM_BUFFER, slot);
}

}  // namespace

bool has_size(const Light& light) {
    if (light.kind == LightKind::Sun) return light.sun_angle > 0;
    if (light.kind == LightKind::Area) return light.area_size.x > 0 || light.area_size.y > 0;
    return light.radius > 0;
}

PenumbraParams make_penumbra_params(const PenumbraSettings& settings, const Light& light, const LightSample& sample) {
    PenumbraParams params{};
    params.width = glm::vec4(float(settings.width), float(settings.width_px), float(settings.filter), 0.0f);
    if (light.kind == LightKind::Area) {
        const glm::dmat3 axes = compute_light_axes(light.world_from_light);
        params.light_u =
            glm::vec4(glm::vec3(0.5 * light.area_size.x * axes[0]), light.area_round ? kDiscShape : kSquareShape);
        params.light_v = glm::vec4(glm::vec3(0.5 * light.area_size.y * axes[1]), 1.0f);
    } else {
        const double radius = light.kind == LightKind::Sun ? sun_radius(light) : light.radius;
        params.light_u = glm::vec4(float(radius), 0.0f, 0.0f, kDiscShape);
    }
    const auto views = get_shader_views(sample);
    for (std::size_t layer = 0; layer < views.size(); ++layer) {
        const LightView& view = views[layer];
        params.map_depths[layer] =
            glm::vec4(float(view.near_ls), float(view.far_ls), view.perspective ? 1.0f : 0.0f, 0.0f);
    }
    return params;
}

void PenumbraBlocks::bind(Engine& engine, const LightTask& task, const PenumbraSettings& settings) {
    const LightSample& sample = task.sample;
    write_block(engine, light_buf_, make_light_params(task.frame, task.light, sample), kLightParamsSlot,
                "light params");
    write_block(engine, camera_buf_, make_pixel_camera(task.frame), kPixelCameraSlot, "pixel camera");
    write_block(engine, penumbra_buf_, make_penumbra_params(settings, task.light, sample), kPenumbraParamsSlot,
                "penumbra params");
}

void BorderSites::prepare_targets(Engine& engine, const Frame& frame) {
    if (!stats_buf_) stats_buf_ = gl::Buffer(engine.device(), sizeof(BorderStats), "border stats");
    candidates_.fit(engine, frame.width, frame.height, {GL_R8UI}, "border candidates");
    sites_.fit(engine, frame.width, frame.height, {GL_R8UI, GL_RGBA32F}, "border sites");
}

PictureTiles BorderSites::find_candidates(Engine& engine, const gl::Texture& hard_tx) {
    const gl::Program& program = engine.program("frame/fullscreen.vert", "techniques/edtsm/edtsm_candidates.frag");
    program.use();
    program.set("u_pixel", 1.0f / glm::vec2(hard_tx.width(), hard_tx.height()));
    hard_tx.bind(kHardVisibilityUnit);
    candidates_.framebuffer().bind();
    engine.draw_fullscreen();
    const auto mask = candidates_.texture().download<std::uint8_t>();
    return PictureTiles(engine.threads(), mask, hard_tx.width(), hard_tx.height());
}

void BorderSites::draw_sites(Engine& engine, const Frame& frame, const PenumbraSettings& settings,
                             const gl::Texture& hard_tx, const gl::Texture* depth_map_tx, const PictureTiles& tiles) {
    const gl::Program& program =
        engine.program(PictureTiles::kVertexShader, "techniques/edtsm/edtsm_sites.frag", settings.defines());
    program.use();
    frame.position_tx->bind(kPositionUnit);
    frame.normal_tx->bind(kNormalUnit);
    hard_tx.bind(kHardVisibilityUnit);
    stats_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, kBorderStatsSlot);
    std::optional<gl::ValueSampler> plain;
    if (depth_map_tx) {
        plain.emplace(engine.device(), kDepthMapUnit, "plain depths");
        depth_map_tx->bind(kDepthMapUnit);
    }
    sites_.framebuffer().bind();
    tiles.draw(engine, program, kReadsPerSite);
    engine.gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

BorderSites::Result BorderSites::find(Engine& engine, const Frame& frame, const PenumbraSettings& settings,
                                      const gl::Texture& hard_tx, const gl::Texture* depth_map_tx) {
    const auto timer = engine.time_stage("border_sites");
    prepare_targets(engine, frame);
    PictureTiles tiles = find_candidates(engine, hard_tx);
    stats_buf_.clear();
    sites_.framebuffer().clear_color_uint(0, 0);
    draw_sites(engine, frame, settings, hard_tx, depth_map_tx, tiles);

    BorderStats stats{};
    stats_buf_.read(&stats, sizeof stats);
    return {sites_.texture(0),
            sites_.texture(1),
            std::move(tiles),
            std::int64_t(stats.site_count),
            double(std::bit_cast<float>(stats.largest_radius_bits)),
            double(std::bit_cast<float>(stats.largest_penumbra_bits))};
}

}  // namespace shadow_layers
