// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/engine.h"
#include "engine/picture_target.h"
#include "techniques/edtsm/penumbra_params.h"
#include "techniques/edtsm/picture_tiles.h"
#include "techniques/technique.h"

namespace shadow_layers {

/// How wide a penumbra is, and how it is measured.
struct PenumbraSettings {
    bool from_light = true;      ///< else the fixed widths below
    bool screen_metric = false;  ///< distances in pixels, else in scene units
    double width = 0;            ///< scene units, without screen_metric
    double width_px = 0;         ///< with screen_metric
    double filter = 0;           ///< mean filter's size as a part of the penumbra's width; 0: none

    gl::Defines defines() const {
        return {{"FROM_LIGHT", from_light ? "1" : "0"}, {"SCREEN_METRIC", screen_metric ? "1" : "0"}};
    }
};

/// False: from a light without size nothing gets soft.
bool has_size(const Light& light);

PenumbraParams make_penumbra_params(const PenumbraSettings& settings, const Light& light, const LightSample& sample);

/// Finds the sites of a hard shadow's border: pixels with a neighbour on the same surface that the map answers
/// differently. Kept by a technique between frames.
class BorderSites {
public:
    struct Result {
        const gl::Texture& mask_tx;    ///< R8UI: 1 = a site
        const gl::Texture& border_tx;  ///< RGBA32F, at sites only: shaders/techniques/edtsm/edtsm_sites.frag
        PictureTiles tiles;            ///< that hold all sites
        std::int64_t site_count = 0;
        double radius_px = 0;    ///< how far from a site anything changes, at most
        double penumbra_px = 0;  ///< the widest penumbra on the screen
    };

    /// `hard_tx`: R32F, the frame's hard visibility. `depth_map_tx`: may be null unless the width comes from the light.
    /// The light's and the camera's uniform blocks must be bound (PenumbraBlocks).
    Result find(Engine& engine, const Frame& frame, const PenumbraSettings& settings, const gl::Texture& hard_tx,
                const gl::Texture* depth_map_tx);

    std::size_t byte_size() const { return candidates_.byte_size() + sites_.byte_size(); }

private:
    void prepare_targets(Engine& engine, const Frame& frame);
    PictureTiles find_candidates(Engine& engine, const gl::Texture& hard_tx);
    void draw_sites(Engine& engine, const Frame& frame, const PenumbraSettings& settings, const gl::Texture& hard_tx,
                    const gl::Texture* depth_map_tx, const PictureTiles& tiles);

    PictureTarget candidates_, sites_;  ///< sites: the mask, and the border's points
    gl::Buffer stats_buf_;
};

/// The uniform blocks of edtsm's passes.
class PenumbraBlocks {
public:
    void bind(Engine& engine, const LightTask& task, const PenumbraSettings& settings);

private:
    gl::Buffer light_buf_, camera_buf_, penumbra_buf_;
};

}  // namespace shadow_layers
