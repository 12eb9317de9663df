// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/receiver_source.h"

#include <cmath>
#include <string>

#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

// Of a place's size: what a position rounded to float may be off, with much to spare.
constexpr double kRounding = 1e-5;

bool is_finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

}  // namespace

ReceiverSource::ReceiverSource(const Frame& frame)
    : scene(frame.scene.get()),
      origin_ws(frame.origin_ws),
      positions_rel(frame.positions_rel),
      normals(frame.normals),
      ids(frame.ids),
      coverage(frame.coverage),
      frame_(&frame) {}

ReceiverSource::ReceiverSource(const Scene& the_scene, const glm::dvec3& origin, std::span<const glm::dvec3> places_rel)
    : scene(&the_scene), origin_ws(origin), places_rel_(places_rel) {}

glm::dvec3 ReceiverSource::find_place(std::size_t i) const {
    if (!frame_) return places_rel_[i];
    const auto width = std::size_t(frame_->width);
    const auto [origin, direction] = frame_->ray_at(double(i % width) + 0.5, double(i / width) + 0.5);
    const std::array<glm::dvec3, 3> corners = get_corners_rel(ids[i]);
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const glm::dvec3 rounded(positions_rel[i]);
    const double along = glm::dot(normal, direction);
    if (along == 0) return rounded;
    const glm::dvec3 found = origin + direction * (glm::dot(normal, corners[0] - origin) / along);
    // The frame holds rays that just miss an edge-on face within the face's depths; so does this.
    const double off = glm::length(found - rounded);
    return off <= kRounding * (glm::length(rounded) + glm::length(origin)) ? found : rounded;
}

std::array<glm::dvec3, 3> ReceiverSource::get_corners_rel(const PixelIds& triangle) const {
    return find_corners_rel(*scene, origin_ws, triangle);
}

PointReceivers::PointReceivers(const Scene& scene, std::span<const glm::dvec3> places_ws,
                               std::span<const glm::dvec3> normals)
    : scene_(scene) {
    if (normals.size() != places_ws.size())
        throw InputError(std::to_string(places_ws.size()) + " points have " + std::to_string(normals.size()) +
                         " normals; give one each");
    glm::dvec3 low(0.0), high(0.0);
    for (std::size_t i = 0; i < places_ws.size(); ++i) {
        const glm::dvec3& place = places_ws[i];
        const double length = glm::length(normals[i]);
        if (!is_finite(place) || !(length > 0) || !std::isfinite(length))
            throw InputError("point " + std::to_string(i) + ": its place must be finite, its normal not zero");
        low = i == 0 ? place : glm::min(low, place);
        high = i == 0 ? place : glm::max(high, place);
        normals_.emplace_back(normals[i] / length);
    }
    origin_ws_ = 0.5 * (low + high);
    for (const glm::dvec3& place : places_ws) {
        places_rel_.push_back(place - origin_ws_);
        positions_rel_.emplace_back(places_rel_.back());
    }
    ids_.resize(places_ws.size());
    coverage_.assign(places_ws.size(), 1);
}

ReceiverSource PointReceivers::source() const {
    ReceiverSource source(scene_, origin_ws_, places_rel_);
    source.positions_rel = positions_rel_;
    source.normals = normals_;
    source.ids = ids_;
    source.coverage = coverage_;
    return source;
}

}  // namespace shadow_layers
