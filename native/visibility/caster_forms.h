// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lights/light_views.h"
#include "shadow_layers/scene.h"
#include "visibility/tile_extent.h"
#include "visibility/tile_kernel.h"

namespace shadow_layers {

/// The triangles of a view's casters as one row of numbered triangles. Scene and view must outlive it.
class CasterRow {
public:
    CasterRow(const Scene& scene, const LightView& view);
    std::size_t size() const { return first_.back(); }

    const std::vector<std::uint32_t>& instances() const { return view_.casters; }
    /// Number of a caster's first triangle.
    std::size_t first(std::size_t caster) const { return first_[caster]; }
    const glm::dmat4& lc_from_object(std::size_t caster) const { return lc_from_object_[caster]; }

    /// Sets up the triangles [begin, end) over the grid: edge functions and depth as linear forms in clip units, the
    /// tiles that they may touch, their ids. Those that touch no tile are left out, and those that the light sees
    /// edge-on, which cast nothing; with the grid's tiles also small ones that no receiver there lies behind. Returns
    /// how many are left; `triangles` has room for end - begin.
    std::size_t set_up(std::size_t begin, std::size_t end, const CasterGrid& grid,
                       tile_kernel::CasterTriangle* triangles) const;

private:
    const Scene& scene_;
    const LightView& view_;
    std::vector<std::size_t> first_;          ///< at the end, of all
    std::vector<glm::dmat4> lc_from_object_;  ///< by caster
};

}  // namespace shadow_layers
