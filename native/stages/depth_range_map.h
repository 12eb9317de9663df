// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "stages/depth_map.h"

namespace shadow_layers {

/// Ranges of a depth map's depths, and of their steps from texel to texel, over windows of texels: most pixels of a
/// filter kernel lie where all its depth tests agree, and these ranges tell (shaders/stages/depth_range.glsl).
///
/// Kept per block of kRangeBlockTexels squared (shaders/shared/depth_range.h), dilated by `radius_texels` and rounded
/// up to whole blocks, so that making it costs a small part of a depth map. RGBA32F arrays with a layer per view.
struct DepthRangeMap {
    std::shared_ptr<const gl::Texture> range_tx, steps_tx;
    std::size_t byte_size() const { return range_tx->byte_size() + steps_tx->byte_size(); }
    void bind() const;  ///< to kDepthRangeUnit and kDepthStepsUnit
};

/// Cached by the depth map's key and the reach: how far taps lie from the receiver's own texel, at most. Adds to
/// "map_bytes". Stage "depth_range".
std::shared_ptr<const DepthRangeMap> render_depth_range_map(Engine& engine, const DepthMap& depth_map,
                                                            int radius_texels);

}  // namespace shadow_layers
