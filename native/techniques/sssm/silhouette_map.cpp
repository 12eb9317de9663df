// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/sssm/silhouette_map.h"

#include "base/hash.h"
#include "light_params.h"
#include "stages/edge_quads.h"

namespace shadow_layers {
namespace {

// A cell that an edge touches has its middle no farther from it than half its diagonal.
constexpr double kHalfWidthTexels = 0.75;

/// Cells lie half a texel up and to the right of the texels of the same number.
std::vector<MapEdge> shift_to_cells(std::vector<MapEdge> edges) {
    for (MapEdge& edge : edges)
        for (glm::vec4* end : {&edge.start, &edge.end}) {
            end->x -= 0.5f;
            end->y -= 0.5f;
        }
    return edges;
}

std::shared_ptr<const SilhouetteMap> draw_silhouette_map(Engine& engine, const MapEdges& found,
                                                         const DepthMap& depth_map) {
    const auto timer = engine.time_stage("silhouette_map");
    const gl::Texture& depth_tx = *depth_map.texture;
    auto texture = std::make_shared<gl::Texture>(
        engine.device(), gl::TextureDesc{GL_RG16F, depth_tx.width(), depth_tx.height(), depth_tx.layers()},
        "silhouette map");
    const gl::Program& program = engine.program("stages/edge_quads.vert", "techniques/sssm/silhouette_map.frag");
    auto made = std::make_shared<SilhouetteMap>();
    made->silhouette_edges = found.silhouette_edges;
    for (int layer = 0; layer < depth_tx.layers(); ++layer) {
        gl::Framebuffer target(engine.device(), "silhouette map layer");
        target.attach_color(0, texture, layer);
        target.bind();
        target.clear_color(0, 0.5f, 0.5f);
        if (std::size_t(layer) >= found.by_view.size()) continue;
        const std::vector<MapEdge> edges = shift_to_cells(found.by_view[std::size_t(layer)]);
        program.use();
        program.set("u_half_width_texels", float(kHalfWidthTexels));
        program.set("u_size_texels", float(depth_tx.width()));
        program.set("u_layer", layer);
        depth_tx.bind(kDepthMapUnit);
        draw_edge_quads(engine, edges, DrawState());
        made->edge_quads += std::int64_t(edges.size());
    }
    made->texture = std::move(texture);
    return made;
}

}  // namespace

std::shared_ptr<const SilhouetteMap> render_silhouette_map(Engine& engine, const Scene& scene,
                                                           const LightSample& sample, const DepthMap& depth_map) {
    MapEdgeOptions options;
    options.half_width_texels = kHalfWidthTexels + 0.5;
    options.silhouettes.skip_concave = true;  // no border of a shadow
    const ContentKey key = KeyBuilder("silhouette_map").add(depth_map.key).key();
    auto map = engine.stages().get<SilhouetteMap>(
        key, [&] { return draw_silhouette_map(engine, find_map_edges(engine, scene, sample, options), depth_map); });
    engine.count("silhouette_edges", map->silhouette_edges);
    engine.count("edge_quads", map->edge_quads);
    engine.count("map_bytes", std::int64_t(map->byte_size()));
    return map;
}

}  // namespace shadow_layers
