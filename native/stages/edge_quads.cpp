// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/edge_quads.h"

#include <algorithm>
#include <span>

namespace shadow_layers {

void draw_edge_quads(Engine& engine, const std::vector<MapEdge>& edges, const DrawState& state) {
    constexpr std::size_t kEdgesPerDraw = 1 << 16;
    for (std::size_t begin = 0; begin < edges.size(); begin += kEdgesPerDraw) {
        engine.check_cancelled();
        const std::size_t count = std::min(kEdgesPerDraw, edges.size() - begin);
        const gl::Buffer edge_buf(engine.device(), std::span<const MapEdge>(edges).subspan(begin, count), "map edges");
        edge_buf.bind_base(GL_SHADER_STORAGE_BUFFER, kEdgeListSlot);
        engine.draw_vertices(state, GL_TRIANGLES, GLsizei(6 * count));
        engine.limit_queue();
    }
}

}  // namespace shadow_layers
