// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "techniques/fsasm/facet.h"
#include "techniques/fsasm/facet_kernel.h"
#include "techniques/fsasm/silhouette_mask.h"

namespace shadow_layers {

/// The facet of a pixel whose shadow may have a border in it, and the masks that its samples get.
struct SilhouetteFacet {
    std::uint32_t pixel = 0;
    std::uint32_t texels = 0;  ///< of the rectangles that it covers, over all views
    int view_count = 0;        ///< views that it reaches into
    SquareForm rel;
    glm::dvec3 normal{0.0};       ///< unit, of its plane
    bool is_turned_away = false;  ///< from the light: dark inside the cone whatever the casters do
    SampleMask outside;           ///< beyond the light's cone: lit
    SampleMask in_view;           ///< inside the cone, and held by a view
    SampleMask occluded, cut;     ///< by casters; lost to the validity mask
};

/// Pixels whose facet covers a silhouette texel ([Pan09] 3.3), in the order of pixels. Also those that the rim of the
/// light's cone cuts, and those beside a pixel of other `visibility` (of the pixels' centres): no silhouette marks the
/// border where a caster passes through the receiver. `masks`: one per view.
std::vector<SilhouetteFacet> find_silhouette_facets(const Frame& frame, const Light& light, const LightSample& sample,
                                                    std::span<const SilhouetteMask> masks,
                                                    std::span<const float> visibility, const SamplePlaces& places,
                                                    ThreadPool& threads);

/// Pixel-texel pairs of one view, sorted by texel. A facet comes into the list of every texel that it touches, not of
/// silhouette texels alone: casters of the other texels shadow its samples, too.
struct PixelTexelPairs {
    int side = 1;
    std::vector<facet_kernel::LightFacet> facets;
    std::vector<facet_kernel::FacetPair> pairs;
    std::vector<tile_kernel::TileContent> texels;  ///< row-major: first pair, count, least depth of the facets

    std::size_t byte_size() const {
        return facets.size() * sizeof(facets[0]) + pairs.size() * sizeof(pairs[0]) + texels.size() * sizeof(texels[0]);
    }
};

/// `facets[i]` is number first_number + i in LightFacet::facet. Notes in each facet which samples the view holds.
PixelTexelPairs make_pairs(std::span<SilhouetteFacet> facets, std::uint32_t first_number, const Frame& frame,
                           const LightView& view, const SamplePlaces& places, ThreadPool& threads);

}  // namespace shadow_layers
