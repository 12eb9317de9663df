// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/receiver_scan.h"

#include <cmath>

#include "base/thread_pool.h"

namespace shadow_layers {

namespace {

constexpr std::size_t kPixelBlock = 1 << 14;
/// What a shader in float may see otherwise than this scan: sines of angles to the face, the cone's width,
/// and a direction's share between two cube faces.
constexpr double kFacingSlack = 1e-6, kConeSlack = 1e-5, kFaceSlack = 1e-4;

Bounds merge(Bounds a, const Bounds& b) {
    a.add(b);
    return a;
}

std::array<Bounds, 6> merge(std::array<Bounds, 6> a, const std::array<Bounds, 6>& b) {
    for (int i = 0; i < 6; ++i) a[i].add(b[i]);
    return a;
}

std::vector<Bounds> merge(std::vector<Bounds> a, const std::vector<Bounds>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i].add(b[i]);
    return a;
}

}  // namespace

ViewAxes compute_face_axes(const glm::dmat3& light_axes, int face) {
    const int axis = face / 2;
    const double sign = face % 2 ? -1 : 1;
    const glm::dvec3 z = -sign * light_axes[axis];
    const glm::dvec3 y = axis == 2 ? light_axes[1] : light_axes[2];
    return {glm::cross(y, z), y, z};
}

ReceiverScan::ReceiverScan(const ReceiverSource& receivers, const Light& light, const LightSample& sample,
                           const glm::dvec3& origin_ws, ThreadPool* threads)
    : receivers_(receivers),
      rule_(receivers, light, sample),
      perspective_(!sample.directional),
      source_from_origin_(receivers.origin_ws - origin_ws),
      threads_(threads) {}

bool ReceiverScan::find_receiver(std::size_t pixel, glm::dvec3& from_origin) const {
    if (!receivers_.is_receiver(pixel)) return false;
    const glm::dvec3 to_light = rule_.get_to_light(pixel);
    const double along = glm::dot(glm::dvec3(receivers_.normals[pixel]), to_light);
    if (!(along > 0) && !(along * along < kFacingSlack * kFacingSlack * glm::dot(to_light, to_light))) return false;
    if (!rule_.is_in_cone(to_light, kConeSlack)) return false;
    if (!rule_.is_linked(receivers_.ids[pixel].instance)) return false;
    from_origin = source_from_origin_ + glm::dvec3(receivers_.positions_rel[pixel]);
    return true;
}

template <class Result, class Add>
Result ReceiverScan::collect(std::size_t stride, const Result& empty, const Add& add) const {
    const std::size_t count = receivers_.count();
    std::vector<Result> parts((count + kPixelBlock - 1) / kPixelBlock, empty);
    const auto scan = [&](std::size_t begin, std::size_t end) {
        for (std::size_t first = begin; first < end; first += kPixelBlock) {
            Result part = empty;
            glm::dvec3 from_origin;
            for (std::size_t pixel = (first + stride - 1) / stride * stride; pixel < std::min(first + kPixelBlock, end);
                 pixel += stride)
                if (find_receiver(pixel, from_origin)) add(from_origin, part);
            parts[first / kPixelBlock] = std::move(part);
        }
    };
    if (threads_)
        threads_->parallel_for(count, kPixelBlock, scan);
    else
        scan(0, count);
    Result all = empty;
    for (const Result& part : parts) all = merge(std::move(all), part);
    return all;
}

Bounds ReceiverScan::measure(const ViewAxes& axes) const {
    const bool perspective = perspective_;
    return collect(1, Bounds(), [&axes, perspective](const glm::dvec3& from_origin, Bounds& box) {
        const double x = glm::dot(axes[0], from_origin), y = glm::dot(axes[1], from_origin);
        const double depth = -glm::dot(axes[2], from_origin);
        if (!perspective)
            box.add({x, y, depth});
        else if (depth > 0)
            box.add({x / depth, y / depth, depth});
    });
}

std::vector<Bounds> ReceiverScan::measure_turns(const ViewAxes& axes, std::span<const double> turns,
                                                std::size_t stride) const {
    std::vector<glm::dvec2> directions;
    for (const double turn : turns) directions.emplace_back(std::cos(turn), std::sin(turn));
    const bool perspective = perspective_;
    return collect(stride, std::vector<Bounds>(turns.size()),
                   [&, perspective](const glm::dvec3& from_origin, std::vector<Bounds>& boxes) {
                       const double depth = -glm::dot(axes[2], from_origin);
                       if (perspective && !(depth > 0)) return;
                       const double scale = perspective ? 1 / depth : 1;
                       const double x = scale * glm::dot(axes[0], from_origin),
                                    y = scale * glm::dot(axes[1], from_origin);
                       for (std::size_t i = 0; i < boxes.size(); ++i) {
                           const glm::dvec2& d = directions[i];
                           boxes[i].add({d.x * x + d.y * y, d.x * y - d.y * x, depth});
                       }
                   });
}

std::array<Bounds, 6> ReceiverScan::measure_faces(const glm::dmat3& light_axes) const {
    std::array<ViewAxes, 6> faces;
    for (int face = 0; face < 6; ++face) faces[face] = compute_face_axes(light_axes, face);
    return collect(1, std::array<Bounds, 6>(), [&](const glm::dvec3& from_origin, std::array<Bounds, 6>& boxes) {
        const glm::dvec3 local = glm::transpose(light_axes) * from_origin;
        const glm::dvec3 magnitude = glm::abs(local);
        const double least = (1 - kFaceSlack) * std::max({magnitude.x, magnitude.y, magnitude.z});
        if (!(least > 0)) return;  // at the light's own position: no face sees it
        for (int axis = 0; axis < 3; ++axis) {
            if (magnitude[axis] < least) continue;
            const int face = 2 * axis + (local[axis] < 0 ? 1 : 0);
            const ViewAxes& view = faces[face];
            const double x = glm::dot(view[0], from_origin), y = glm::dot(view[1], from_origin);
            boxes[face].add({x / magnitude[axis], y / magnitude[axis], magnitude[axis]});
        }
    });
}

}  // namespace shadow_layers
