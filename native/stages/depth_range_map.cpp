// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/depth_range_map.h"

#include "base/hash.h"
#include "depth_range.h"
#include "engine/banded_draw.h"
#include "gl/sampler.h"
#include "light_params.h"

namespace shadow_layers {
namespace {

struct RangeTextures {
    std::shared_ptr<gl::Texture> range_tx, steps_tx;

    RangeTextures(Engine& engine, int side_blocks, int layers) {
        const gl::TextureDesc desc{GL_RGBA32F, side_blocks, side_blocks, layers};
        range_tx = std::make_shared<gl::Texture>(engine.device(), desc, "depth range");
        steps_tx = std::make_shared<gl::Texture>(engine.device(), desc, "depth steps");
    }
    void bind() const {
        range_tx->bind(kDepthRangeUnit);
        steps_tx->bind(kDepthStepsUnit);
    }
    /// Draws all layers with the program in use, which knows them by u_layer.
    void fill(Engine& engine, const gl::Program& program, double reads_per_block) const {
        for (int layer = 0; layer < range_tx->layers(); ++layer) {
            gl::Framebuffer target(engine.device(), "depth range layer");
            target.attach_color(0, range_tx, layer);
            target.attach_color(1, steps_tx, layer);
            target.bind();
            program.set("u_layer", layer);
            draw_fullscreen_in_bands(engine, target.width(), target.height(), reads_per_block);
        }
    }
};

void dilate(Engine& engine, const RangeTextures& from, const RangeTextures& to, const glm::ivec2& axis,
            int radius_blocks) {
    const gl::Program& program = engine.program("frame/fullscreen.vert", "stages/depth_range_dilate.frag");
    program.use();
    program.set("u_axis", axis);
    program.set("u_radius_blocks", radius_blocks);
    from.bind();
    to.fill(engine, program, 4 * radius_blocks + 2);
}

std::shared_ptr<const DepthRangeMap> draw_depth_range_map(Engine& engine, const DepthMap& depth_map,
                                                          int radius_texels) {
    const auto timer = engine.time_stage("depth_range");
    const gl::Texture& depth_tx = *depth_map.texture;
    const int side_blocks = (depth_tx.width() + kRangeBlockTexels - 1) / kRangeBlockTexels;
    const int radius_blocks = (radius_texels + kRangeBlockTexels - 1) / kRangeBlockTexels;
    const RangeTextures made(engine, side_blocks, depth_tx.layers());
    {
        const gl::Program& program = engine.program("frame/fullscreen.vert", "stages/depth_range_blocks.frag");
        const gl::ValueSampler plain(engine.device(), kDepthMapUnit, "plain depths");
        program.use();
        depth_tx.bind(kDepthMapUnit);
        made.fill(engine, program, kRangeBlockTexels * kRangeBlockTexels);
    }
    if (radius_blocks > 0) {
        const RangeTextures rows(engine, side_blocks, depth_tx.layers());
        dilate(engine, made, rows, {1, 0}, radius_blocks);
        dilate(engine, rows, made, {0, 1}, radius_blocks);
    }
    auto map = std::make_shared<DepthRangeMap>();
    map->range_tx = made.range_tx;
    map->steps_tx = made.steps_tx;
    return map;
}

}  // namespace

void DepthRangeMap::bind() const {
    range_tx->bind(kDepthRangeUnit);
    steps_tx->bind(kDepthStepsUnit);
}

std::shared_ptr<const DepthRangeMap> render_depth_range_map(Engine& engine, const DepthMap& depth_map,
                                                            int radius_texels) {
    const ContentKey key = KeyBuilder("depth_range_map").add(depth_map.key).add(radius_texels).key();
    auto map =
        engine.stages().get<DepthRangeMap>(key, [&] { return draw_depth_range_map(engine, depth_map, radius_texels); });
    engine.count("map_bytes", std::int64_t(map->byte_size()));
    return map;
}

}  // namespace shadow_layers
