// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/extsm/extended_shadow_map.h"

#include <algorithm>
#include <functional>
#include <span>

#include "base/hash.h"
#include "light_params.h"
#include "stages/edge_quads.h"

namespace shadow_layers {
namespace {

/// Larger values win in both channels.
DrawState blending_state() {
    DrawState state;
    state.blend = true;
    state.blend_equation = GL_MAX;
    return state;
}

void draw_quads(Engine& engine, const std::vector<ExtendedQuad>& quads, const DrawState& state) {
    constexpr std::size_t kQuadsPerDraw = 1 << 16;
    for (std::size_t begin = 0; begin < quads.size(); begin += kQuadsPerDraw) {
        engine.check_cancelled();
        const std::size_t count = std::min(kQuadsPerDraw, quads.size() - begin);
        const gl::Buffer quad_buf(engine.device(), std::span<const ExtendedQuad>(quads).subspan(begin, count),
                                  "extended quads");
        quad_buf.bind_base(GL_SHADER_STORAGE_BUFFER, kExtendedQuadSlot);
        engine.draw_vertices(state, GL_TRIANGLES, GLsizei(6 * count));
        engine.limit_queue();
    }
}

/// Clears each layer, makes it the target and calls `draw(layer)`.
void draw_layers(Engine& engine, const gl::Program& program, const DepthMap& depth_map,
                 const ExtendedMapOptions& options, ExtendedShadowMap& made, const std::function<void(int)>& draw) {
    const auto timer = engine.time_stage("extended_map");
    const gl::Texture& depth_tx = *depth_map.texture;
    const auto add_texture = [&](GLenum format, const char* label) {
        return std::make_shared<gl::Texture>(
            engine.device(), gl::TextureDesc{format, depth_tx.width(), depth_tx.height(), depth_tx.layers()}, label);
    };
    made.values = add_texture(GL_R8, "edge values");
    made.depths = add_texture(GL_R32F, "edge depths");
    depth_tx.bind(kDepthMapUnit);
    program.use();
    program.set("u_size_texels", float(depth_tx.width()));
    program.set("u_depth_sign", options.depth_sign());
    if (options.forced)
        program.set("u_half_width_texels", float(options.half_width_texels()));
    else
        program.set("u_guard_zone", float(options.guard_zone));
    for (int layer = 0; layer < depth_tx.layers(); ++layer) {
        gl::Framebuffer target(engine.device(), "extended map layer");
        target.attach_color(0, made.values, layer);
        target.attach_color(1, made.depths, layer);
        target.bind();
        target.clear_color(0, 0);
        target.clear_color(1, kNoEdgeClear);
        program.use();
        program.set("u_layer", layer);
        draw(layer);
    }
}

}  // namespace

std::shared_ptr<const ExtendedShadowMap> render_extended_shadow_map(Engine& engine, const Scene& scene,
                                                                    const LightSample& sample,
                                                                    const DepthMap& depth_map,
                                                                    const ExtendedMapOptions& options) {
    KeyBuilder builder("extended_map");
    builder.add(depth_map.key).add(options.farthest_edge).add(options.forced);
    if (!options.forced) builder.add(options.guard_zone);
    const auto draw_forced = [&] {
        auto made = std::make_shared<ExtendedShadowMap>();
        const MapEdges found = find_map_edges(engine, scene, sample,
                                              {.silhouettes = {.skip_concave = true, .skip_two_sided = true},
                                               .half_width_texels = options.half_width_texels()});
        made->silhouette_edges = found.silhouette_edges;
        for (const auto& edges : found.by_view) made->edge_quads += std::int64_t(edges.size());
        const gl::Program& program = engine.program("stages/edge_quads.vert", "techniques/extsm/extsm_edges.frag");
        draw_layers(engine, program, depth_map, options, *made, [&](int layer) {
            if (std::size_t(layer) < found.by_view.size())
                draw_edge_quads(engine, found.by_view[std::size_t(layer)], blending_state());
        });
        return made;
    };
    const auto draw_extruded = [&] {
        auto made = std::make_shared<ExtendedShadowMap>();
        const ExtendedQuads found = find_extended_quads(engine, scene, sample);
        made->silhouette_edges = found.silhouette_edges;
        made->bevelled_edges = found.bevelled_edges;
        for (const auto& quads : found.by_view) made->edge_quads += std::int64_t(quads.size());
        const gl::Program& program =
            engine.program("techniques/extsm/extsm_quads.vert", "techniques/extsm/extsm_quads.frag");
        draw_layers(engine, program, depth_map, options, *made, [&](int layer) {
            if (std::size_t(layer) < found.by_view.size())
                draw_quads(engine, found.by_view[std::size_t(layer)], blending_state());
        });
        return made;
    };
    const auto map = engine.stages().get<ExtendedShadowMap>(
        builder.key(), [&] { return options.forced ? draw_forced() : draw_extruded(); });
    engine.count("silhouette_edges", map->silhouette_edges);
    engine.count("bevelled_edges", map->bevelled_edges);
    engine.count("edge_quads", map->edge_quads);
    engine.count("map_bytes", std::int64_t(map->byte_size()));
    return map;
}

}  // namespace shadow_layers
