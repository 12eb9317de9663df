// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "frame/receiver_source.h"
#include "lights/light_views.h"

namespace shadow_layers {

/// Part of its size that the corners of a flat face may lie off its plane: they are rounded to float, by some 1e-7 of
/// it.
inline constexpr double kFlatTolerance = 1e-6;

/// Does a triangle lie between a receiver and the light? The exact answer, one pair at a time, in double. Techniques
/// that decide most pairs in float ask it where float can't tell.
///
/// Rules: a triangle's rim belongs to it, and the corners of an edge are always taken in the same order, so that two
/// triangles at an edge leave no crack. A triangle that the light sees edge-on casts nothing. The receiver's own
/// triangle, and triangles that share an edge with it and lie in its plane, do not shadow it: their rounded corners
/// would. No bias: everything else that lies strictly between receiver and light does.
class OcclusionRule {
public:
    /// What `receivers` is made of must outlive the rule.
    OcclusionRule(const ReceiverSource& receivers, const LightSample& sample);

    /// Where receiver i is exactly, relative to the source's origin.
    glm::dvec3 find_receiver(std::size_t i) const { return receivers_.find_place(i); }

    /// `receiver_rel` lies on triangle `receiver`; a free point (kNoId) on none, so that all triangles may shadow it.
    bool is_blocked(const glm::dvec3& receiver_rel, const PixelIds& receiver, const PixelIds& caster) const;
    /// From another sample of the light than the rule was made for.
    bool is_blocked(const glm::dvec3& receiver_rel, const PixelIds& receiver, const PixelIds& caster,
                    const LightSample& sample) const;

    /// Does the triangle never shadow what lies on `receiver`, because it is that triangle or a flat neighbour of it?
    bool is_own_surface(const PixelIds& receiver, const PixelIds& caster) const;

    /// How far a triangle's corners may be off because a mesh keeps them in float.
    double find_corner_rounding(const PixelIds& ids) const;

private:
    ReceiverSource receivers_;
    LightSample sample_;  ///< its place alone
};

/// Does a triangle lie in the plane through a point, as far as the rounding of its corners lets one tell? It does not
/// shadow places of that plane then. For techniques that look at a receiver's plane beyond its own triangle, where more
/// than the neighbours may be flat. `rounding`: of the corners, in scene units.
bool lies_in_plane(const glm::dvec3& point, const glm::dvec3& unit_normal, const std::array<glm::dvec3, 3>& corners,
                   double rounding);

}  // namespace shadow_layers
