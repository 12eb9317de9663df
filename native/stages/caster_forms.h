// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lights/light_views.h"
#include "shadow_layers/scene.h"
#include "stages/tile_kernel.h"

namespace shadow_layers {

/// The triangles of a view's casters as one row of numbered triangles. Scene and view must outlive it.
class CasterRow {
public:
    CasterRow(const Scene& scene, const LightView& view);
    std::size_t size() const { return first_.back(); }

    /// Sets up the triangle of this number over side x side tiles of the view: edge functions and depth as linear forms
    /// in clip units, the tiles that it may touch, its ids. `margin`: by how many clip units a receiver may be off.
    /// False if no tile is touched, or if the light sees the triangle edge-on, so that it casts nothing. With
    /// `receivers_in_tile` (side x side counts), small triangles over empty tiles are left out too.
    bool set_up(std::size_t number, int side, double margin, tile_kernel::CasterTriangle& triangle,
                const std::uint32_t* receivers_in_tile = nullptr) const;

private:
    const Scene& scene_;
    const LightView& view_;
    std::vector<std::size_t> first_;          ///< number of each caster's first triangle; at the end, of all
    std::vector<glm::dmat4> lc_from_object_;  ///< by caster
};

}  // namespace shadow_layers
