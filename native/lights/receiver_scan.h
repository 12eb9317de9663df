// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "lights/facing.h"
#include "lights/light_views.h"

namespace shadow_layers {

/// The axes of a view in world space: columns x, y, z; it looks along -z.
using ViewAxes = glm::dmat3;

/// Axes of cube face `face` (+X -X +Y -Y +Z -Z) of a light sample's axes.
ViewAxes compute_face_axes(const glm::dmat3& light_axes, int face);

/// Where the lit receivers of a source lie as seen from a light sample: boxes of (u, v, depth). Perspective: u = x /
/// depth, v = y / depth, depth along -z from the light. Sun: u = x, v = y, depth = -z, from `origin_ws`.
///
/// A receiver counts if the light may light it (FacingRule, widened by what float arithmetic may decide otherwise).
class ReceiverScan {
public:
    ReceiverScan(const ReceiverSource& receivers, const Light& light, const LightSample& sample,
                 const glm::dvec3& origin_ws, ThreadPool* threads);

    Bounds measure(const ViewAxes& axes) const;
    /// One view turned about its own z axis by each of `turns` (radians), from every `stride`-th pixel.
    std::vector<Bounds> measure_turns(const ViewAxes& axes, std::span<const double> turns, std::size_t stride) const;
    /// Per cube face the receivers whose direction falls in it; near a cube's edge they count for both faces.
    std::array<Bounds, 6> measure_faces(const glm::dmat3& light_axes) const;

private:
    template <class Result, class Add>
    Result collect(std::size_t stride, const Result& empty, const Add& add) const;
    bool find_receiver(std::size_t pixel, glm::dvec3& from_origin) const;

    ReceiverSource receivers_;
    FacingRule rule_;
    bool perspective_;
    glm::dvec3 source_from_origin_;  ///< of the view: its origin to the receivers'
    ThreadPool* threads_;
};

}  // namespace shadow_layers
