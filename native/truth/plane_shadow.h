// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "truth/triangle_tree.h"
#include "truth/union_area.h"

namespace shadow_layers::truth {

/// Shadows on the planes that the pixels of a frame see, as areas: no samples. For one position of a light.
///
/// Light and camera are central projections (or parallel ones), so a caster's shadow on a plane, seen by the camera, is
/// the image of the caster under one projective map, whose numerator and denominator are linear in the caster's points.
/// So each caster is cut by planes to what lies over the receiver's plane, before the light, and shadows the pixel's
/// square; what is left maps to a convex polygon in the square, and the polygons' common area is the shadow.
class PlaneShadows {
public:
    /// All must outlive this. The frame needs camera, size, origin, scene, and what its pixels' centres see.
    PlaneShadows(const RayOracle& oracle, const TriangleTree& tree, const Frame& frame, const Light& light,
                 const LightSample& position);

    /// The part of the pixel's square, 0 to 1, that the light reaches on the plane of the triangle that the pixel's
    /// centre sees, as if that plane were endless and alone; triangles that lie in it don't cast. Exactly 0 or 1 where
    /// less than 1e-9 of it is lit or in shadow. Nothing where the
    /// centre is no receiver turned to the light (Standing::Facing), the plane's horizon or the rim of the light's cone
    /// crosses the square.
    std::optional<double> find_lit_part(std::size_t pixel) const;

    /// Whether the camera sees that plane through the whole square, and nothing else: triangles in the plane, linked to
    /// the light, and none before it. Nothing that is true is missed but for slits of some 1e-9 of the square.
    bool sees_plane_alone(std::size_t pixel) const;

private:
    struct Facet;
    std::optional<Facet> find_facet(std::size_t pixel) const;
    bool is_in_cone(const Facet& facet) const;
    bool may_cast(const PixelIds& ids) const;

    const RayOracle& oracle_;
    const TriangleTree& tree_;
    const Frame& frame_;
    const Light& light_;
    const LightSample& position_;
    LightRule rule_;
};

}  // namespace shadow_layers::truth
