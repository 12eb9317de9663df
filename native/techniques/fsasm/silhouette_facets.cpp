// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "lights/facing.h"
#include "techniques/fsasm/facet_pairs.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kPixelBlock = 1 << 13;
// A rectangle is widened by so many texels, far more than a place is rounded.
constexpr double kPlaceMargin = 1.0 / 128;

/// A view's clip space, and how fast its rows grow with the place.
struct ClipSpace {
    glm::dmat4 lc_from_rel;
    double growth_x, growth_y, growth_w;
};

ClipSpace make_clip_space(const LightView& view, const glm::dvec3& origin_ws) {
    ClipSpace space;
    space.lc_from_rel = view.lc_from_ws * glm::translate(glm::dmat4(1.0), origin_ws);
    const glm::dmat4 rows = glm::transpose(space.lc_from_rel);
    space.growth_x = glm::length(glm::dvec3(rows[0]));
    space.growth_y = glm::length(glm::dvec3(rows[1]));
    space.growth_w = glm::length(glm::dvec3(rows[3]));
    return space;
}

class FacetFinder {
public:
    FacetFinder(const Frame& frame, const Light& light, const LightSample& sample,
                std::span<const SilhouetteMask> masks, std::span<const float> visibility, const SamplePlaces& places)
        : frame_(frame),
          sample_(sample),
          masks_(masks),
          visibility_(visibility),
          places_(places),
          rule_(frame, light, sample),
          rays_(frame.camera, frame.width, frame.height),
          maker_(frame) {
        for (const LightView& view : sample.views) spaces_.push_back(make_clip_space(view, frame.origin_ws));
        has_cone_ = sample.cone_cos > -1;
        origin_step_ = 0.5 * (glm::length(rays_.origin_dx) + glm::length(rays_.origin_dy));
        direction_step_ = 0.5 * (glm::length(rays_.direction_dx) + glm::length(rays_.direction_dy));
    }

    std::vector<SilhouetteFacet> find(ThreadPool& threads) {
        facing_.resize(frame_.pixel_count());
        threads.parallel_for(frame_.pixel_count(), kPixelBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t pixel = begin; pixel < end; ++pixel) facing_[pixel] = rule_.classify(pixel);
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
    void judge(std::size_t pixel, std::vector<SilhouetteFacet>& found) const {
        const Facing facing = facing_[pixel];
        if (facing == Facing::Background || facing == Facing::Unlinked) return;
        if (facing != Facing::Undecided && !has_cone_) return;
        const double radius = bound_radius(pixel);
        const bool may_be_cut = has_cone_ && is_cut_by_cone(frame_.positions_rel[pixel], radius);
        const bool is_border = facing == Facing::Undecided && differs_from_neighbours(pixel);
        if (!may_be_cut && !is_border && (facing != Facing::Undecided || is_far_from_silhouettes(pixel, radius)))
            return;
        const auto made = maker_.make(pixel);
        if (!made) return;
        SilhouetteFacet facet;
        facet.pixel = std::uint32_t(pixel);
        facet.rel = made->rel;
        facet.normal = made->normal;
        facet.is_turned_away = !is_turned_to_light(pixel);
        const bool is_cut = may_be_cut && is_cut_by_cone(glm::dvec3(facet.rel.at), find_radius(facet.rel));
        if (is_cut) facet.outside = find_outside(facet.rel);
        if (!is_cut && facing != Facing::Undecided) return;
        const bool covers = covers_silhouette(facet);
        if (covers || is_cut || is_border) found.push_back(facet);
    }

    /// At least the distance of the facet's corners from its centre, in scene units. A step of the ray aside moves its
    /// meeting with the plane by that step and by what it is longer or shorter along the ray.
    double bound_radius(std::size_t pixel) const {
        const double x = double(pixel % std::size_t(frame_.width)) + 0.5;
        const double y = double(pixel / std::size_t(frame_.width)) + 0.5;
        const glm::dvec3 origin = rays_.origin_at(x, y), direction = rays_.direction_at(x, y);
        const double length = glm::length(direction);
        const double depth = glm::length(glm::dvec3(frame_.positions_rel[pixel]) - origin) / length;
        const double along = std::abs(glm::dot(glm::dvec3(frame_.normals[pixel]), direction));
        // Normals are rounded; half of a grazing plane's slope is more than that.
        if (!(along > 2 * direction_step_ && along > 1e-4 * length)) return std::numeric_limits<double>::infinity();
        const double step = depth * direction_step_ + origin_step_;
        return 1.01 * step * (length + along) / (along - direction_step_);
    }

    /// Is every texel within that radius of the pixel's centre free of silhouettes?
    bool is_far_from_silhouettes(std::size_t pixel, double radius) const {
        for (std::size_t view = 0; view < spaces_.size(); ++view) {
            const ClipSpace& space = spaces_[view];
            const glm::dvec4 lc = space.lc_from_rel * glm::dvec4(frame_.positions_rel[pixel], 1.0);
            const double least_w = lc.w - radius * space.growth_w;
            if (!(least_w > 0)) {
                if (lc.w + radius * space.growth_w > 0) return false;
                continue;  // wholly behind the view
            }
            const double x = lc.x / lc.w, y = lc.y / lc.w, half = 0.5 * masks_[view].side();
            const double radius_x = radius * (space.growth_x + std::abs(x) * space.growth_w) / least_w;
            const double radius_y = radius * (space.growth_y + std::abs(y) * space.growth_w) / least_w;
            TexelRect rect;
            set_range((x - radius_x + 1) * half, (x + radius_x + 1) * half, masks_[view].side(), rect.column_begin,
                      rect.column_end);
            set_range((y - radius_y + 1) * half, (y + radius_y + 1) * half, masks_[view].side(), rect.row_begin,
                      rect.row_end);
            if (!rect.is_empty() && masks_[view].count(rect) > 0) return false;
        }
        return true;
    }

    static void set_range(double low, double high, int side, int& begin, int& end) {
        begin = int(std::clamp(std::floor(low - kPlaceMargin), 0.0, double(side)));
        end = int(std::clamp(std::floor(high + kPlaceMargin) + 1, 0.0, double(side)));
    }

    bool differs_from_neighbours(std::size_t pixel) const {
        const int width = frame_.width, x = int(pixel % std::size_t(width)), y = int(pixel / std::size_t(width));
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, frame_.height - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
                const std::size_t other = std::size_t(v) * std::size_t(width) + std::size_t(u);
                if (facing_[other] == Facing::Undecided && visibility_[other] != visibility_[pixel]) return true;
            }
        return false;
    }

    bool covers_silhouette(SilhouetteFacet& facet) const {
        bool covers = false;
        for (std::size_t view = 0; view < masks_.size(); ++view) {
            const Footprint footprint(facet.rel.transformed(spaces_[view].lc_from_rel), masks_[view].side());
            const TexelRect& rect = footprint.rect();
            if (rect.is_empty()) continue;
            ++facet.view_count;
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
        if (sample_.directional) return sample_.to_light_ws;
        return sample_.position_ws - frame_.origin_ws - glm::dvec3(rel) / rel.w;
    }

    /// Does the cone's surface come nearer than that to the place?
    bool is_cut_by_cone(const glm::dvec3& place_rel, double radius) const {
        const glm::dvec3 to_light = find_to_light(glm::dvec4(place_rel, 1));
        const facing::Source& source = rule_.source();
        const auto parts = facing::find_cone_parts<double>(source, {to_light.x, to_light.y, to_light.z});
        return std::abs(parts.across * sample_.cone_cos - parts.along * sample_.cone_sin) <=
               radius * facing::find_cone_stretch(source);
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
    const LightSample& sample_;
    std::span<const SilhouetteMask> masks_;
    std::span<const float> visibility_;
    const SamplePlaces& places_;
    const FacingRule rule_;
    const RayBasis rays_;
    const FacetMaker maker_;
    bool has_cone_ = false;
    double origin_step_, direction_step_;  ///< of a ray, from a pixel's centre to its corner
    std::vector<ClipSpace> spaces_;
    std::vector<Facing> facing_;
};

}  // namespace

std::vector<SilhouetteFacet> find_silhouette_facets(const Frame& frame, const Light& light, const LightSample& sample,
                                                    std::span<const SilhouetteMask> masks,
                                                    std::span<const float> visibility, const SamplePlaces& places,
                                                    ThreadPool& threads) {
    return FacetFinder(frame, light, sample, masks, visibility, places).find(threads);
}

}  // namespace shadow_layers
