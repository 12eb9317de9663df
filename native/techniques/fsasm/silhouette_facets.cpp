// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "lights/facing.h"
#include "techniques/fsasm/facet_pairs.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kPixelBlock = 1 << 13;
// Places are kept in float: in the largest map this many texels are more than they are rounded.
constexpr float kPlaceMargin = 1.0f / 128;

/// A pixel's centre in the map of the view that holds it.
struct Place {
    float x, y;
    std::int8_t view = -1;  ///< -1: none holds it
    Facing facing = Facing::Background;
};

class FacetFinder {
public:
    FacetFinder(const Frame& frame, const Light& light, const LightPosition& position,
                std::span<const SilhouetteMask> masks, std::span<const float> visibility, const SamplePlaces& places)
        : frame_(frame),
          position_(position),
          masks_(masks),
          visibility_(visibility),
          places_(places),
          rule_(frame, light, position),
          maker_(frame) {
        const glm::dmat4 ws_from_rel = glm::translate(glm::dmat4(1.0), frame.origin_ws);
        for (const LightView& view : position.views) lc_from_rel_.push_back(view.lc_from_ws * ws_from_rel);
        has_cone_ = position.cone_cos > -1;
    }

    std::vector<SilhouetteFacet> find(ThreadPool& threads) {
        centres_.resize(frame_.pixel_count());
        threads.parallel_for(frame_.pixel_count(), kPixelBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t pixel = begin; pixel < end; ++pixel) centres_[pixel] = place(pixel);
        });
        std::vector<std::vector<SilhouetteFacet>> blocks((frame_.pixel_count() + kPixelBlock - 1) / kPixelBlock);
        threads.parallel_for(frame_.pixel_count(), kPixelBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t pixel = begin; pixel < end; ++pixel) judge(pixel, blocks[begin / kPixelBlock]);
        });
        std::vector<SilhouetteFacet> facets;
        for (const auto& block : blocks) facets.insert(facets.end(), block.begin(), block.end());
        return facets;
    }

private:
    Place place(std::size_t pixel) const {
        Place result{0, 0, -1, rule_.classify(pixel)};
        if (result.facing != Facing::Lit) return result;
        for (std::size_t view = 0; view < lc_from_rel_.size(); ++view) {
            const glm::dvec4 lc = lc_from_rel_[view] * glm::dvec4(frame_.positions_rel[pixel], 1.0);
            if (!(lc.w > 0 && std::abs(lc.x) <= lc.w && std::abs(lc.y) <= lc.w)) continue;
            const double texels = 0.5 * position_.views[view].size_texels;
            result.x = float((lc.x / lc.w + 1) * texels);
            result.y = float((lc.y / lc.w + 1) * texels);
            result.view = std::int8_t(view);
            break;
        }
        return result;
    }

    void judge(std::size_t pixel, std::vector<SilhouetteFacet>& found) const {
        const Facing facing = centres_[pixel].facing;
        if (facing == Facing::Background || facing == Facing::Unlinked) return;
        if (facing != Facing::Lit && !has_cone_) return;
        const bool is_border = facing == Facing::Lit && differs_from_neighbours(pixel);
        bool is_silhouette = false;
        if (!is_border && judge_by_neighbours(pixel, is_silhouette) && !is_silhouette) return;
        const auto rel = maker_.make(pixel);
        if (!rel) return;
        SilhouetteFacet facet;
        facet.pixel = std::uint32_t(pixel);
        facet.rel = *rel;
        facet.is_turned_away = !is_turned_to_light(pixel);
        const bool is_cut = has_cone_ && is_cut_by_cone(*rel);
        if (is_cut) facet.outside = find_outside(*rel);
        if (!is_cut && facing != Facing::Lit) return;
        const bool covers = covers_silhouette(facet);
        if (covers || is_cut || is_border) found.push_back(facet);
    }

    bool differs_from_neighbours(std::size_t pixel) const {
        const int width = frame_.width, x = int(pixel % std::size_t(width)), y = int(pixel / std::size_t(width));
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, frame_.height - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
                const std::size_t other = std::size_t(v) * std::size_t(width) + std::size_t(u);
                if (centres_[other].facing == Facing::Lit && visibility_[other] != visibility_[pixel]) return true;
            }
        return false;
    }

    /// False if the neighbours can't tell. The plane's places within the square lie between those of the 3 x 3 pixels.
    bool judge_by_neighbours(std::size_t pixel, bool& is_silhouette) const {
        const int width = frame_.width, x = int(pixel % std::size_t(width)), y = int(pixel / std::size_t(width));
        if (x == 0 || y == 0 || x == width - 1 || y == frame_.height - 1) return false;
        const Place& centre = centres_[pixel];
        float low_x = centre.x, high_x = centre.x, low_y = centre.y, high_y = centre.y;
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) {
                const std::size_t other = pixel + std::size_t(j * width + i);
                const Place& place = centres_[other];
                if (place.facing != centre.facing || place.view != centre.view ||
                    frame_.ids[other].triangle != frame_.ids[pixel].triangle ||
                    frame_.ids[other].instance != frame_.ids[pixel].instance)
                    return false;
                low_x = std::min(low_x, place.x);
                high_x = std::max(high_x, place.x);
                low_y = std::min(low_y, place.y);
                high_y = std::max(high_y, place.y);
            }
        if (centre.facing != Facing::Lit) return true;  // wholly outside the cone, or wholly turned away inside it
        if (centre.view < 0) return false;
        const SilhouetteMask& mask = masks_[std::size_t(centre.view)];
        const auto clamp = [&](float place) { return std::clamp(int(std::floor(place)), 0, mask.side() - 1); };
        is_silhouette = mask.count({clamp(low_x - kPlaceMargin), clamp(high_x + kPlaceMargin) + 1,
                                    clamp(low_y - kPlaceMargin), clamp(high_y + kPlaceMargin) + 1}) > 0;
        return true;
    }

    bool covers_silhouette(SilhouetteFacet& facet) const {
        bool covers = false;
        for (std::size_t view = 0; view < masks_.size(); ++view) {
            const Footprint footprint(facet.rel.transformed(lc_from_rel_[view]), masks_[view].side());
            const TexelRect& rect = footprint.rect();
            if (rect.is_empty()) continue;
            facet.texels +=
                std::uint32_t(rect.column_end - rect.column_begin) * std::uint32_t(rect.row_end - rect.row_begin);
            covers = covers || masks_[view].count(rect) > 0;
        }
        return covers;
    }

    bool is_turned_to_light(std::size_t pixel) const {
        return glm::dot(glm::dvec3(frame_.normals[pixel]), rule_.get_to_light(pixel)) > 0;
    }

    glm::dvec3 find_to_light(const glm::dvec4& rel) const {
        if (position_.directional) return position_.to_light_ws;
        return position_.position_ws - frame_.origin_ws - glm::dvec3(rel) / rel.w;
    }

    /// The cone's surface comes nearer to the facet's centre than its corners are.
    bool is_cut_by_cone(const SquareForm& rel) const {
        const glm::dvec3 to_light = find_to_light(rel.at);
        const glm::dvec2 across(glm::dot(position_.axes_ws[0], to_light), glm::dot(position_.axes_ws[1], to_light));
        const double along = glm::dot(position_.axes_ws[2], to_light);
        return std::abs(glm::length(across) * position_.cone_cos - along * position_.cone_sin) <= find_reach(rel);
    }

    SampleMask find_outside(const SquareForm& rel) const {
        SampleMask outside;
        for (int i = 0; i < places_.count; ++i) {
            const glm::dvec4 place = rel.value(double(places_.x[std::size_t(i)]), double(places_.y[std::size_t(i)]));
            if (place.w > 0 && !rule_.is_in_cone(find_to_light(place))) outside.set(i);
        }
        return outside;
    }

    const Frame& frame_;
    const LightPosition& position_;
    std::span<const SilhouetteMask> masks_;
    std::span<const float> visibility_;
    const SamplePlaces& places_;
    const FacingRule rule_;
    const FacetMaker maker_;
    bool has_cone_ = false;
    std::vector<glm::dmat4> lc_from_rel_;
    std::vector<Place> centres_;
};

}  // namespace

std::vector<SilhouetteFacet> find_silhouette_facets(const Frame& frame, const Light& light,
                                                    const LightPosition& position,
                                                    std::span<const SilhouetteMask> masks,
                                                    std::span<const float> visibility, const SamplePlaces& places,
                                                    ThreadPool& threads) {
    return FacetFinder(frame, light, position, masks, visibility, places).find(threads);
}

}  // namespace shadow_layers
