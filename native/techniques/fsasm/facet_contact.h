// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "techniques/fsasm/facet_pairs.h"
#include "visibility/occlusion_rule.h"

namespace shadow_layers {

/// Which samples of a facet are lost because the pixel sees something else there.
enum class Validity : std::uint8_t {
    Off,   ///< none
    Seen,  ///< those that a caster near the facet hides from the camera
    Line,  ///< those beyond the line where a caster meets the facet ([Pan09] 3.4)
};

/// A caster as the camera sees it; corners relative to the frame's origin.
struct NearCaster {
    PixelIds ids;
    std::array<glm::dvec3, 3> corners;
    glm::dvec3 normal{0.0};             ///< not unit
    std::array<glm::dvec3, 3> edges;    ///< p - q of corners p and q
    std::array<glm::dvec3, 3> volumes;  ///< p x q
    double rounding = 0;                ///< of its corners
    bool is_seen = true;                ///< by the camera: else it takes no samples away
};

/// Pairs of a caster and a facet that come near each other within the pixel: a caster in the facet's plane does
/// nothing, others shadow their samples. Then the validity mask:
///
/// - Line: of a caster that meets the facet within the pixel, samples on the other side of that line than the centre
///   are lost. A caster that meets it from below, as at a convex edge, costs nothing.
/// - Seen: samples at which the caster lies between camera and facet are lost. That is what the line stands for; it
///   also holds for surfaces that rise a little above the facet without meeting it, and ends where the caster ends.
class FacetContacts {
public:
    FacetContacts(const Frame& frame, const OcclusionRule& rule, const facet_kernel::Samples& samples,
                  Validity validity);

    NearCaster describe(const PixelIds& caster) const;

    /// `occluded`: samples that the caster shadows by its conditions. Thread-safe for different pairs.
    void settle(const SilhouetteFacet& owner, const NearCaster& caster, const facet_kernel::LightFacet& facet,
                const facet_kernel::Conditions& conditions, const std::uint32_t (&occluded)[facet_kernel::kWords],
                facet_kernel::FacetPair& pair) const;

private:
    void cut_beyond_line(const facet_kernel::LightFacet& facet, const facet_kernel::Conditions& conditions,
                         facet_kernel::FacetPair& pair) const;
    void cut_hidden(const SilhouetteFacet& owner, const NearCaster& caster, facet_kernel::FacetPair& pair) const;

    const Frame& frame_;
    const OcclusionRule& rule_;
    const facet_kernel::Samples& samples_;
    Validity validity_;
    RayBasis rays_;
    const facet_kernel::Build& build_ = facet_kernel::choose_build();
};

}  // namespace shadow_layers
