// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/edsm/edge_distance_map.h"

#include <algorithm>

#include "base/hash.h"
#include "light_params.h"
#include "stages/edge_quads.h"

namespace shadow_layers {
namespace {

// GL 4.6 or ARB_pipeline_statistics_query; the loader knows 4.5.
constexpr GLenum kFragmentShaderInvocations = 0x82F4;

/// Counts shaded fragments while it lives; without the extension, those that pass the depth test.
class FragmentCounter {
public:
    explicit FragmentCounter(const gl::Device& device)
        : gl_(device.gl()),
          target_(device.has_extension("GL_ARB_pipeline_statistics_query") ? kFragmentShaderInvocations
                                                                           : GL_SAMPLES_PASSED) {
        gl_.GenQueries(1, &query_);
        gl_.BeginQuery(target_, query_);
    }
    ~FragmentCounter() {
        if (!ended_) gl_.EndQuery(target_);
        gl_.DeleteQueries(1, &query_);
    }
    FragmentCounter(const FragmentCounter&) = delete;
    FragmentCounter& operator=(const FragmentCounter&) = delete;
    std::int64_t read() {
        gl_.EndQuery(target_);
        ended_ = true;
        GLuint64 count = 0;
        gl_.GetQueryObjectui64v(query_, GL_QUERY_RESULT, &count);
        return std::int64_t(count);
    }

private:
    const GladGLContext& gl_;
    GLenum target_;
    GLuint query_ = 0;
    bool ended_ = false;
};

DrawState sorting_state(EdgeOrder order) {
    DrawState state;
    state.depth_test = state.depth_write = true;
    state.depth_function = order == EdgeOrder::Stream ? GL_ALWAYS : GL_LESS;
    return state;
}

std::shared_ptr<const EdgeDistanceMap> draw_edge_distance_map(Engine& engine, const MapEdges& found,
                                                              const LightSample& sample, const DepthMap& depth_map,
                                                              const EdgeDistanceOptions& options) {
    const auto timer = engine.time_stage("edge_distance_map");
    const gl::Texture& depth_tx = *depth_map.texture;
    auto texture = std::make_shared<gl::Texture>(
        engine.device(), gl::TextureDesc{GL_RGBA16F, depth_tx.width(), depth_tx.height(), depth_tx.layers()},
        "edge map");
    auto priority_tx = std::make_shared<gl::Texture>(
        engine.device(), gl::TextureDesc{GL_DEPTH_COMPONENT32F, depth_tx.width(), depth_tx.height()}, "edge priority");
    const gl::Program& program = engine.program(
        "stages/edge_quads.vert", "techniques/edsm/edge_distance_map.frag",
        {{"EDGE_ORDER", std::to_string(int(options.order))}, {"OWN_TEXEL_TEST", options.own_texel_test ? "1" : "0"}});
    program.use();
    program.set("u_half_width_texels", float(options.edges.half_width_texels));
    program.set("u_size_texels", float(depth_tx.width()));
    depth_tx.bind(kDepthMapUnit);

    auto made = std::make_shared<EdgeDistanceMap>();
    made->silhouette_edges = found.silhouette_edges;
    FragmentCounter fragments(engine.device());
    for (int layer = 0; layer < depth_tx.layers(); ++layer) {
        gl::Framebuffer target(engine.device(), "edge map layer");
        target.attach_color(0, texture, layer);
        target.attach_depth(priority_tx);
        target.bind();
        target.clear_color(0, 0, 0, 0, kNoEdgeDepth);
        target.clear_depth(1.0f);  // a priority, not a depth: smallest wins
        if (std::size_t(layer) >= found.by_view.size()) continue;
        program.use();
        program.set("u_layer", layer);
        program.set("u_depth_scale", float(compute_edge_depth_scale(sample.views[std::size_t(layer)])));
        draw_edge_quads(engine, found.by_view[std::size_t(layer)], sorting_state(options.order));
        made->edge_quads += std::int64_t(found.by_view[std::size_t(layer)].size());
    }
    made->edge_fragments = fragments.read();
    made->texture = std::move(texture);
    return made;
}

}  // namespace

double compute_edge_depth_scale(const LightView& view) {
    return view.perspective ? std::max(view.far_ls / view.near_ls - 1, 1.0) : 1.0;
}

std::shared_ptr<const EdgeDistanceMap> render_edge_distance_map(Engine& engine, const Scene& scene,
                                                                const LightSample& sample, const DepthMap& depth_map,
                                                                const EdgeDistanceOptions& options) {
    const ContentKey key = KeyBuilder("edge_distance_map")
                               .add(depth_map.key)
                               .add(options.edges.half_width_texels)
                               .add(options.edges.foreshortened)
                               .add(options.edges.silhouettes.skip_concave)
                               .add(options.edges.silhouettes.skip_two_sided)
                               .add(options.order)
                               .add(options.own_texel_test)
                               .key();
    auto map = engine.stages().get<EdgeDistanceMap>(key, [&] {
        return draw_edge_distance_map(engine, find_map_edges(engine, scene, sample, options.edges), sample, depth_map,
                                      options);
    });
    engine.count("silhouette_edges", map->silhouette_edges);
    engine.count("edge_quads", map->edge_quads);
    engine.count("edge_fragments", map->edge_fragments);
    engine.count("map_bytes", std::int64_t(map->byte_size()));
    return map;
}

}  // namespace shadow_layers
