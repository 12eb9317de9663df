// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "frame/frame.h"

namespace shadow_layers {

/// Where light is asked for: the pixels of a frame, or points with normals that need no camera. Refers to what it is
/// made of, which must outlive it.
struct ReceiverSource {
    const Scene* scene;
    glm::dvec3 origin_ws;                      ///< of the space "_rel"
    std::span<const glm::vec3> positions_rel;  ///< rounded
    std::span<const glm::vec3> normals;        ///< unit, to the side that is asked about
    std::span<const PixelIds> ids;             ///< where a receiver lies; kNoId: a free point
    std::span<const std::uint8_t> coverage;    ///< 1 = a receiver

    /// A frame is a source as it is.
    ReceiverSource(const Frame& frame);  // NOLINT(google-explicit-constructor)
    /// `places_rel`: of all points, exact.
    ReceiverSource(const Scene& the_scene, const glm::dvec3& origin, std::span<const glm::dvec3> places_rel);

    std::size_t count() const { return positions_rel.size(); }
    bool is_receiver(std::size_t i) const { return coverage[i] && (ids[i].instance != kNoId || !frame_); }
    /// Where receiver i is, relative to the origin: where a pixel centre's ray meets the plane of its triangle; of a
    /// point its own place.
    glm::dvec3 find_place(std::size_t i) const;
    /// Corners of a triangle relative to the origin.
    std::array<glm::dvec3, 3> get_corners_rel(const PixelIds& triangle) const;

private:
    const Frame* frame_ = nullptr;
    std::span<const glm::dvec3> places_rel_;  ///< of points
};

/// Points with normals as receivers. They lie on no triangle: none is taken for their own, so a point that is meant to
/// lie on a surface must stand off it by more than its rounding.
class PointReceivers {
public:
    /// World space; `normals` need not be of unit length. InputError where the counts differ or a value is not finite.
    /// `scene` must outlive the receivers.
    PointReceivers(const Scene& scene, std::span<const glm::dvec3> places_ws, std::span<const glm::dvec3> normals);

    ReceiverSource source() const;

private:
    const Scene& scene_;
    glm::dvec3 origin_ws_{0.0};  ///< the middle of the points
    std::vector<glm::dvec3> places_rel_;
    std::vector<glm::vec3> positions_rel_, normals_;
    std::vector<PixelIds> ids_;
    std::vector<std::uint8_t> coverage_;
};

}  // namespace shadow_layers
