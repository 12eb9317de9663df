// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/revectorised_filter.h"

#include "stages/depth_map.h"
#include "stages/depth_range_map.h"

namespace shadow_layers {
namespace {

constexpr int kMostTileTexels = 27;  // with a rim of two texels on each side, a line has 31 bits
constexpr double kReadsPerTap = 40;  // of the reference: sides, and two walks where there are any

int rim(const RevectorisedFilterSettings& settings) { return settings.smooth ? 2 : 1; }

gl::Defines make_defines(const RevectorisedFilterSettings& settings) {
    return {{"KERNEL", std::to_string(settings.kernel)},
            {"SPACING", std::to_string(settings.spacing_texels)},
            {"SMOOTH", settings.smooth ? "1" : "0"},
            {"CHANNELS", settings.cases_of_paper ? "kChannelsPaper" : "kChannelsDisjoint"}};
}

bool takes_single_taps(const RevectorisedFilterSettings& settings) {
    return !settings.early_out && settings.kernel <= kMostSingleTaps;
}

/// Kernels are cut into equal tiles, each of which begins with a tap.
struct Tiles {
    int texels = 1, count = 1;  ///< per side
};

Tiles cut_tiles(const RevectorisedFilterSettings& settings) {
    const int extent = (settings.kernel - 1) * settings.spacing_texels + 1;
    Tiles tiles;
    tiles.count = (extent + kMostTileTexels - 1) / kMostTileTexels;
    const auto round_up = [&](int texels) {
        return (texels + settings.spacing_texels - 1) / settings.spacing_texels * settings.spacing_texels;
    };
    for (;; ++tiles.count) {
        tiles.texels = (extent + tiles.count - 1) / tiles.count;
        if (tiles.count > 1) tiles.texels = round_up(tiles.texels);
        if (tiles.texels <= kMostTileTexels) return tiles;
    }
}

gl::Defines make_tile_defines(const RevectorisedFilterSettings& settings) {
    const Tiles tiles = cut_tiles(settings);
    unsigned taps = 0;
    for (int k = 0; k < tiles.texels; k += settings.spacing_texels) taps |= 1u << k;
    return {{"TILE", std::to_string(tiles.texels)},
            {"TILES", std::to_string(tiles.count)},
            {"TAP_BITS", std::to_string(taps) + "u"}};
}

double count_reads(const RevectorisedFilterSettings& settings) {
    if (takes_single_taps(settings)) return kReadsPerTap * settings.kernel * settings.kernel;
    const Tiles tiles = cut_tiles(settings);
    const double side = tiles.count * (tiles.texels + 2 * rim(settings));
    return 2 * side * side;
}

}  // namespace

int RevectorisedFilterSettings::window_radius() const { return ((kernel - 1) * spacing_texels + 1) / 2 + rim(*this); }

void RevectorisedFilterPass::prepare(Engine& engine, const RevectorisedFilterSettings& settings) {
    if (evaluator_ && settings == settings_) return;
    settings_ = settings;
    gl::Defines defines = make_defines(settings);
    const std::string folder = "stages/revectorised_filter/";
    if (takes_single_taps(settings)) {
        evaluator_ = &engine.program("frame/fullscreen.vert", folder + "taps.frag", defines);
    } else {
        gl::Defines with_tiles = make_tile_defines(settings);
        with_tiles.insert(defines.begin(), defines.end());
        evaluator_ = &engine.program("frame/fullscreen.vert", folder + "segments.frag", with_tiles);
    }
    defines["EARLY_OUT"] = std::string(settings.early_out ? "1" : "0");  // gcc 12 warns falsely of a literal
    decider_ = &engine.program("frame/fullscreen.vert", folder + "decide.frag", defines);
}

const gl::Texture& RevectorisedFilterPass::run(Engine& engine, const Frame& frame, const Light& light,
                                               const LightSample& sample) {
    const auto map = render_depth_map(engine, *frame.scene, sample);
    const int window_radius = settings_.window_radius();
    const auto ranges = settings_.early_out ? render_depth_range_map(engine, *map, window_radius) : nullptr;
    return resolve_.run(engine, {.frame = frame,
                                 .light = light,
                                 .sample = sample,
                                 .program = *decider_,
                                 .second_program = evaluator_,
                                 .second_work_per_pixel = count_reads(settings_),
                                 .bind_inputs =
                                     [&] {
                                         map->texture->bind(kDepthMapUnit);
                                         if (ranges) ranges->bind();
                                         decider_->set("u_radius_texels", float(window_radius));
                                     },
                                 .bind_second_inputs = [&] { evaluator_->set("u_walk_limit", settings_.walk_limit); }});
}

}  // namespace shadow_layers
