// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/fsasm/facet_contact.h"

#include <algorithm>
#include <cmath>

namespace shadow_layers {
namespace {

using facet_kernel::Conditions;
using facet_kernel::kWords;

// Casters that miss the facet by this part of its depth touch it: their corners are rounded.
constexpr double kTouch = 1e-5;
constexpr int kMostCorners = 8;

double value_at(const Conditions& c, int i, const glm::dvec2& place) {
    return c.at[i] + c.by_x[i] * place.x + c.by_y[i] * place.y;
}

/// Least and greatest value of the caster's plane over what its edges leave of the square; least > greatest if nothing
/// is left.
void find_plane_range(const Conditions& c, double& least, double& greatest) {
    glm::dvec2 corners[kMostCorners] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    int count = 4;
    for (int edge = 0; edge < 3; ++edge) {
        glm::dvec2 kept[kMostCorners];
        int kept_count = 0;
        for (int i = 0; i < count; ++i) {
            const glm::dvec2 &from = corners[i], &to = corners[(i + 1) % count];
            const double at_from = value_at(c, edge, from) + c.error[edge],
                         at_to = value_at(c, edge, to) + c.error[edge];
            if (at_from >= 0) kept[kept_count++] = from;
            if ((at_from >= 0) != (at_to >= 0)) kept[kept_count++] = from + (at_from / (at_from - at_to)) * (to - from);
        }
        std::copy(kept, kept + kept_count, corners);
        count = kept_count;
    }
    least = 1;
    greatest = -1;
    for (int i = 0; i < count; ++i) {
        const double value = value_at(c, 3, corners[i]);
        least = i == 0 ? value : std::min(least, value);
        greatest = i == 0 ? value : std::max(greatest, value);
    }
}

}  // namespace

FacetContacts::FacetContacts(const Frame& frame, const OcclusionRule& rule, const facet_kernel::Samples& samples,
                             Validity validity)
    : frame_(frame),
      rule_(rule),
      samples_(samples),
      validity_(validity),
      rays_(frame.camera, frame.width, frame.height) {}

NearCaster FacetContacts::describe(const PixelIds& caster) const {
    NearCaster result;
    result.ids = caster;
    result.corners = frame_.get_corners_rel(caster);
    result.normal = glm::cross(result.corners[1] - result.corners[0], result.corners[2] - result.corners[0]);
    result.rounding = rule_.find_corner_rounding(caster);
    result.is_seen = (frame_.scene->instances[caster.instance].flags & kInstanceCamera) != 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 &p = result.corners[i], &q = result.corners[(i + 1) % 3];
        result.edges[i] = p - q;
        result.volumes[i] = glm::cross(p, q);
    }
    return result;
}

void FacetContacts::settle(const SilhouetteFacet& owner, const NearCaster& caster,
                           const facet_kernel::LightFacet& facet, const Conditions& c,
                           const std::uint32_t (&occluded)[kWords], facet_kernel::FacetPair& pair) const {
    if (lies_in_plane(glm::dvec3(owner.rel.at), owner.normal, caster.corners, caster.rounding)) return;
    for (int word = 0; word < kWords; ++word) pair.occluded[word] |= occluded[word];
    if (!caster.is_seen) return;
    if (validity_ == Validity::Line) cut_beyond_line(facet, c, pair);
    if (validity_ == Validity::Seen) cut_hidden(owner, caster, pair);
}

void FacetContacts::cut_beyond_line(const facet_kernel::LightFacet& facet, const Conditions& c,
                                    facet_kernel::FacetPair& pair) const {
    double least, greatest;
    find_plane_range(c, least, greatest);
    const double touch = kTouch * facet.depth_extent + c.error[3];
    if (least > greatest || least > touch || greatest <= touch) return;
    const double side = c.at[3] >= 0 ? 1 : -1;
    std::uint32_t kept[kWords] = {~0u, ~0u, ~0u, ~0u};
    build_.mask_half_plane(samples_, {side * c.at[3], side * c.by_x[3], side * c.by_y[3]}, 0, kept);
    for (int word = 0; word < kWords; ++word) pair.cut[word] |= ~kept[word];
}

void FacetContacts::cut_hidden(const SilhouetteFacet& owner, const NearCaster& caster,
                               facet_kernel::FacetPair& pair) const {
    const double x = double(owner.pixel % std::uint32_t(frame_.width)) + 0.5;
    const double y = double(owner.pixel / std::uint32_t(frame_.width)) + 0.5;
    const glm::dvec3 origin = rays_.origin_at(x, y), direction = rays_.direction_at(x, y);
    const double facing = -glm::dot(caster.normal, direction);
    if (facing == 0) return;
    const double side = facing > 0 ? -1 : 1;
    facet_kernel::LinearForm forms[4];
    // The volume of ray and edge, d . (p - o) x (q - o), is linear over the square like o or d, whichever is not the
    // same for all rays.
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 area = caster.volumes[i] + glm::cross(origin, caster.edges[i]);
        const glm::dvec3 along = glm::cross(caster.edges[i], direction);
        forms[i] = {side * glm::dot(direction, area),
                    side * (glm::dot(rays_.direction_dx, area) + glm::dot(rays_.origin_dx, along)),
                    side * (glm::dot(rays_.direction_dy, area) + glm::dot(rays_.origin_dy, along))};
    }
    const glm::dvec4 plane(caster.normal, -glm::dot(caster.normal, caster.corners[0]));
    forms[3] = {side * glm::dot(plane, owner.rel.at), side * glm::dot(plane, owner.rel.by_x),
                side * glm::dot(plane, owner.rel.by_y)};
    const auto half_range = [](const facet_kernel::LinearForm& f) {
        return 0.5 * (std::abs(f.by_x) + std::abs(f.by_y));
    };
    for (const auto& form : forms)
        if (form.at_origin + half_range(form) < 0) return;
    std::uint32_t hidden[kWords] = {~0u, ~0u, ~0u, ~0u};
    for (const auto& form : forms)
        if (form.at_origin < half_range(form)) build_.mask_half_plane(samples_, form, 0, hidden);
    for (int word = 0; word < kWords; ++word) pair.cut[word] |= hidden[word];
}

}  // namespace shadow_layers
