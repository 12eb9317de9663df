// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/engine.h"
#include "lights/light_views.h"

namespace shadow_layers {

/// What a light sample sees: DEPTH_COMPONENT32F array, one layer per view, reversed depth, compared with GL_GEQUAL by
/// shadow samplers (result 1 = lit), nearest filter.
///
/// Each caster is pushed away from the light by `slope_factor` times its own depth slope per texel,
/// g = max(|dz/dx|, |dz/dy|). A texel's depth is right at its centre only, and a neighbouring face may bend towards the
/// light by that much before the next centre; no constant in scene units is needed.
struct DepthMap {
    std::shared_ptr<const gl::Texture> texture;
    ContentKey key;
    std::size_t byte_size() const { return texture->byte_size(); }
};

/// The push of the variants with receiver-plane comparison (docs/techniques/edsm.md, "B").
inline constexpr double kReceiverPlaneSlopeFactor = 0.5;

/// Cached by the views' keys. A sample without views gives a map of one empty texel. Counts "map_bytes".
std::shared_ptr<const DepthMap> render_depth_map(Engine& engine, const Scene& scene, const LightSample& sample,
                                                 double slope_factor = kReceiverPlaneSlopeFactor);

}  // namespace shadow_layers
