// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/fsasm/facet_pairs.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <utility>

namespace shadow_layers {
namespace {

using facet_kernel::FacetPair;
using facet_kernel::LightFacet;
using tile_kernel::TileContent;

constexpr std::size_t kFacetBlock = 1 << 10;
// Planes this near to the facet, as a part of its depth, are settled with care.
constexpr double kContact = 1e-5;
// Beyond the rounding of a depth that is kept as a float.
constexpr double kDepthReserve = 1e-6;

void copy(const SampleMask& mask, std::uint32_t (&words)[facet_kernel::kWords]) {
    std::copy(mask.words.begin(), mask.words.end(), words);
}

/// Scaled so that |w| is 1 at most.
LightFacet make_light_facet(const SquareForm& lc) {
    const double size = std::abs(lc.at.w) + 0.5 * (std::abs(lc.by_x.w) + std::abs(lc.by_y.w));
    const double scale = size > 0 ? 1 / size : 1;
    LightFacet facet{};
    double bound[4];
    for (int i = 0; i < 4; ++i) {
        facet.at[i] = lc.at[i] * scale;
        facet.by_x[i] = lc.by_x[i] * scale;
        facet.by_y[i] = lc.by_y[i] * scale;
        bound[i] = std::abs(facet.at[i]) + 0.5 * (std::abs(facet.by_x[i]) + std::abs(facet.by_y[i]));
    }
    facet.extent = bound[0] + bound[1] + bound[3];
    facet.depth_extent = bound[2];
    return facet;
}

/// Bound of depth_rz over the square, less what counts as near: a caster below it shadows none of the facet.
float find_least_depth(const LightFacet& f) {
    const double radius = 0.5 * (std::abs(f.by_x[3]) + std::abs(f.by_y[3])), nearest = f.at[3] - radius;
    if (!(nearest > 0)) return -std::numeric_limits<float>::infinity();
    const double least = f.at[2] - 0.5 * (std::abs(f.by_x[2]) + std::abs(f.by_y[2])) - f.near;
    const double depth = least >= 0 ? least / (f.at[3] + radius) : least / nearest;
    return float(depth - kDepthReserve * std::abs(depth));
}

void add_to(TileContent& texel, float least_depth) {
    texel.least_depth = texel.count == 0 ? least_depth : std::min(texel.least_depth, least_depth);
    ++texel.count;
}

/// The pairs of a block of facets, before they are sorted.
struct PairBlock {
    std::vector<LightFacet> facets;
    std::vector<float> least_depths;                             ///< of each facet
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  ///< texel, facet of the block
};

class PairMaker {
public:
    PairMaker(std::span<SilhouetteFacet> facets, std::uint32_t first_number, const Frame& frame, const LightView& view,
              const SamplePlaces& places)
        : facets_(facets),
          first_number_(first_number),
          frame_(frame),
          view_(view),
          lc_from_rel_(view.lc_from_ws * glm::translate(glm::dmat4(1.0), frame.origin_ws)),
          side_(view.size_texels),
          places_(places) {}

    PixelTexelPairs make(ThreadPool& threads) {
        std::vector<PairBlock> blocks((facets_.size() + kFacetBlock - 1) / kFacetBlock);
        threads.parallel_for(facets_.size(), kFacetBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) add_facet(i, blocks[begin / kFacetBlock]);
        });
        return sort(blocks);
    }

private:
    void add_facet(std::size_t number, PairBlock& block) {
        SilhouetteFacet& facet = facets_[number];
        if (facet.is_turned_away) return;
        const SquareForm lc = facet.rel.transformed(lc_from_rel_);
        const Footprint footprint(lc, side_);
        if (footprint.rect().is_empty()) return;
        LightFacet light_facet = make_light_facet(lc);
        light_facet.near = std::max(kContact * light_facet.depth_extent, find_near_depth(facet.rel, lc, light_facet));
        SampleMask in_view = find_in_view(lc, places_);
        in_view.remove(facet.outside);
        facet.in_view |= in_view;
        copy(in_view, light_facet.in_view);
        light_facet.is_alone = facet.view_count == 1 && facet.outside.is_empty();
        light_facet.facet = first_number_ + std::uint32_t(number);
        light_facet.instance = frame_.ids[facet.pixel].instance;
        light_facet.triangle = frame_.ids[facet.pixel].triangle;
        const std::uint32_t in_block = std::uint32_t(block.facets.size());
        block.facets.push_back(light_facet);
        block.least_depths.push_back(find_least_depth(light_facet));
        for (int row = footprint.rect().row_begin; row < footprint.rect().row_end; ++row) {
            int begin, end;
            footprint.find_columns(row, begin, end);
            for (int column = begin; column < end; ++column)
                block.pairs.push_back({std::uint32_t(row) * std::uint32_t(side_) + std::uint32_t(column), in_block});
        }
    }

    /// Depth, in the form's units, by which the light's way grows over the facet's own size.
    double find_near_depth(const SquareForm& rel, const SquareForm& lc, const LightFacet& light_facet) const {
        const double depth = lc.at.w, near = view_.near_ls, far = view_.far_ls;
        if (!(depth > 0)) return 0;
        const double slope = view_.perspective ? near * far / ((far - near) * depth * depth) : 1 / (far - near);
        return slope * find_radius(rel) * light_facet.at[3];
    }

    PixelTexelPairs sort(const std::vector<PairBlock>& blocks) const {
        PixelTexelPairs result;
        result.side = side_;
        result.texels.resize(std::size_t(side_) * std::size_t(side_));
        for (const PairBlock& block : blocks)
            for (const auto& [texel, facet] : block.pairs) add_to(result.texels[texel], block.least_depths[facet]);
        std::uint32_t total = 0;
        for (TileContent& texel : result.texels) {
            texel.first = total;
            total += std::exchange(texel.count, 0);  // counted again below
        }
        result.pairs.resize(total);
        for (const PairBlock& block : blocks) {
            const std::uint32_t base = std::uint32_t(result.facets.size());
            for (const auto& [index, facet] : block.pairs) {
                TileContent& texel = result.texels[index];
                result.pairs[texel.first + texel.count++].light_facet = base + facet;
            }
            result.facets.insert(result.facets.end(), block.facets.begin(), block.facets.end());
        }
        return result;
    }

    std::span<SilhouetteFacet> facets_;
    std::uint32_t first_number_;
    const Frame& frame_;
    const LightView& view_;
    glm::dmat4 lc_from_rel_;
    int side_;
    const SamplePlaces& places_;
};

}  // namespace

PixelTexelPairs make_pairs(std::span<SilhouetteFacet> facets, std::uint32_t first_number, const Frame& frame,
                           const LightView& view, const SamplePlaces& places, ThreadPool& threads) {
    return PairMaker(facets, first_number, frame, view, places).make(threads);
}

}  // namespace shadow_layers
