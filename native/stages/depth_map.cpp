// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/depth_map.h"

#include <algorithm>

#include "base/hash.h"
#include "engine/scene_draw.h"

namespace shadow_layers {
namespace {

/// Polygon offset while it lives. Away from the light is towards smaller reversed depth.
class SlopeOffset {
public:
    SlopeOffset(const GladGLContext& gl, double factor) : gl_(gl) {
        gl_.Enable(GL_POLYGON_OFFSET_FILL);
        gl_.PolygonOffset(float(-factor), 0.0f);
    }
    ~SlopeOffset() {
        gl_.Disable(GL_POLYGON_OFFSET_FILL);
        gl_.PolygonOffset(0.0f, 0.0f);
    }
    SlopeOffset(const SlopeOffset&) = delete;
    SlopeOffset& operator=(const SlopeOffset&) = delete;

private:
    const GladGLContext& gl_;
};

std::shared_ptr<const DepthMap> draw_depth_map(Engine& engine, const Scene& scene, const LightSample& sample,
                                               double slope_factor, const ContentKey& key) {
    const auto timer = engine.time_stage("depth_map");
    const int layers = std::max(1, int(sample.views.size()));
    const int size = sample.views.empty() ? 1 : sample.views.front().size_texels;
    auto texture = std::make_shared<gl::Texture>(
        engine.device(), gl::TextureDesc{GL_DEPTH_COMPONENT32F, size, size, layers}, "depth map");
    texture->set_compare(GL_GEQUAL);

    const gl::Program& program = engine.program("stages/depth_map.vert", "stages/depth_map.frag");
    for (int layer = 0; layer < layers; ++layer) {
        gl::Framebuffer target(engine.device(), "depth map layer");
        target.attach_depth(texture, layer);
        target.bind();
        target.clear_depth();
        if (sample.views.empty()) continue;
        const LightView& view = sample.views[std::size_t(layer)];
        if (view.casters.empty()) continue;
        const SlopeOffset offset(engine.gl(), slope_factor);
        DrawState state = DrawState::nearest();
        state.color_write = false;
        state.depth_clamp = true;  // a caster between the light and the near plane still casts
        draw_scene(engine, program, state, {scene, view.casters, view.lc_from_ws});
    }
    auto made = std::make_shared<DepthMap>();
    made->texture = std::move(texture);
    made->key = key;
    return made;
}

}  // namespace

std::shared_ptr<const DepthMap> render_depth_map(Engine& engine, const Scene& scene, const LightSample& sample,
                                                 double slope_factor) {
    KeyBuilder builder("depth_map");
    builder.add(slope_factor).add(sample.views.size());
    for (const LightView& view : sample.views) builder.add(view.key);
    const ContentKey key = builder.key();
    auto map =
        engine.stages().get<DepthMap>(key, [&] { return draw_depth_map(engine, scene, sample, slope_factor, key); });
    engine.count("map_bytes", std::int64_t(map->byte_size()));
    return map;
}

}  // namespace shadow_layers
