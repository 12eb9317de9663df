// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/sv/volume_count.h"

#include <algorithm>
#include <cmath>

#include "lights/facing.h"
#include "lights/view_casters.h"
#include "visibility/occlusion_rule.h"

namespace shadow_layers {
namespace {

// Polygons are made and drawn in chunks, so that memory stays bounded.
constexpr std::size_t kChunk = 1 << 15;
constexpr std::size_t kPolygonBlock = 1 << 9;
constexpr int kBandCount = 32;
// Of sums of a few products in double, against the terms' magnitudes.
constexpr double kDoubleError = 4e-15;

}  // namespace

VolumeCounter::VolumeCounter(Engine& engine, const Frame& frame, const Light& light, const LightSample& sample)
    : engine_(engine),
      frame_(frame),
      light_(light),
      sample_(sample),
      picture_(frame.camera, frame.width, frame.height) {}

std::vector<float> VolumeCounter::compute_visibility() {
    {
        const auto timer = engine_.time_stage("volume_receivers");
        if (!find_receivers()) return std::move(visibility_);
    }
    const auto timer = engine_.time_stage("shadow_volumes");
    polygons_.resize(kChunk);
    ranges_.resize(kChunk);
    count_bytes();
    const Scene& scene = *frame_.scene;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (!casts_for(light_, instance)) continue;
        if (!scene.meshes[instance.mesh]->bounds.is_empty()) draw_instance(i);
    }
    flush();
    for (std::size_t pixel = 0; pixel < visibility_.size(); ++pixel)
        if (!decided_[pixel] && counts_[pixel] != 0) visibility_[pixel] = 0;
    return std::move(visibility_);
}

/// False if no pixel asks.
bool VolumeCounter::find_receivers() {
    const FacingRule facing(frame_, light_, sample_);
    const OcclusionRule rule(frame_, sample_);
    const std::size_t width = std::size_t(frame_.width), height = std::size_t(frame_.height);
    visibility_.resize(frame_.pixel_count());
    counts_.assign(frame_.pixel_count(), 0);
    decided_.assign(frame_.pixel_count(), 1);
    for (auto* axis : {&x_, &y_, &z_}) axis->assign(frame_.pixel_count(), 0.0);
    asked_.assign(height, {});
    std::vector<double> greatest(height, 0.0);
    std::vector<std::int64_t> receivers(height, 0);
    engine_.threads().parallel_for(height, 1, [&](std::size_t row, std::size_t) {
        for (std::size_t pixel = row * width; pixel < (row + 1) * width; ++pixel) {
            const Facing facing_of_pixel = facing.classify(pixel);
            visibility_[pixel] = get_unoccluded_visibility(facing_of_pixel);
            if (facing_of_pixel != Facing::Undecided || !light_.casts_shadow) continue;
            decided_[pixel] = 0;
            const glm::dvec3 p = rule.find_receiver(pixel);
            x_[pixel] = p.x, y_[pixel] = p.y, z_[pixel] = p.z;
            greatest[row] = std::max(greatest[row], std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
            const int column = int(pixel - row * width);
            if (receivers[row]++ == 0) asked_[row].begin = column;
            asked_[row].end = column + 1;
        }
    });
    std::int64_t total = 0;
    for (std::size_t row = 0; row < height; ++row) {
        greatest_rel_ = std::max(greatest_rel_, greatest[row]);
        total += receivers[row];
    }
    engine_.count("receivers", total);
    return total > 0;
}

void VolumeCounter::count_bytes() {
    const std::size_t per_pixel = 3 * sizeof(double) + sizeof counts_.front() + sizeof decided_.front();
    const std::size_t per_polygon = sizeof(VolumePolygon) + sizeof(RowRange);
    engine_.count("list_bytes", std::int64_t(per_pixel * counts_.size() + per_polygon * polygons_.size()));
}

void VolumeCounter::draw_instance(std::uint32_t instance) {
    engine_.check_cancelled();
    const std::uint32_t mesh = frame_.scene->instances[instance].mesh;
    if (!edges_.contains(mesh))
        edges_[mesh] = engine_.mesh_data().get_edges(*frame_.scene->meshes[mesh], &engine_.threads());
    const CasterVolumes volumes(frame_, sample_, picture_, instance, edges_.at(mesh), engine_.threads());
    engine_.count("silhouette_edges", std::int64_t(volumes.side_count()));
    for (std::size_t begin = 0; begin < volumes.size();) {
        const std::size_t count = std::min(volumes.size() - begin, kChunk - used_);
        engine_.threads().parallel_for(count, kPolygonBlock, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i) {
                VolumePolygon& polygon = polygons_[used_ + i];
                const bool seen = volumes.make(begin + i, polygon);
                ranges_[used_ + i] = seen ? RowRange{polygon.box.rows.begin, polygon.box.rows.end} : RowRange{};
            }
        });
        begin += count;
        used_ += count;
        if (used_ == kChunk) flush();
    }
}

void VolumeCounter::flush() {
    engine_.check_cancelled();
    const int rows = (frame_.height + kBandCount - 1) / kBandCount;
    const std::size_t bands = std::size_t((frame_.height + rows - 1) / rows);
    engine_.threads().parallel_for(bands, 1, [&](std::size_t band, std::size_t) {
        draw_band(int(band) * rows, std::min(int(band + 1) * rows, frame_.height));
    });
    std::int64_t sides = 0, caps = 0;
    for (std::size_t i = 0; i < used_; ++i)
        if (ranges_[i].begin < ranges_[i].end) ++(polygons_[i].kind == VolumePolygon::Kind::Side ? sides : caps);
    engine_.count("volume_quads", sides);
    engine_.count("cap_triangles", caps);
    used_ = 0;
}

void VolumeCounter::draw_band(int row_begin, int row_end) {
    for (std::size_t i = 0; i < used_; ++i) {
        const int begin = std::max(ranges_[i].begin, row_begin), end = std::min(ranges_[i].end, row_end);
        for (int row = begin; row < end; ++row) draw(polygons_[i], row);
    }
}

void VolumeCounter::draw(const VolumePolygon& polygon, int row) {
    const PixelSpan asked = asked_[std::size_t(row)];
    const PixelSpan within{std::max(polygon.box.columns.begin, asked.begin),
                           std::min(polygon.box.columns.end, asked.end)};
    if (within.begin >= within.end) return;
    const RowSpans spans = find_row_spans(std::span(polygon.lines).first(polygon.line_count), row, within);
    // With the corners to the left, the ray goes along the outward normal: it leaves the volume.
    const int sign = picture_.handedness();
    if (polygon.kind == VolumePolygon::Kind::FarCap) {
        // Rays that run out through a cap at infinity leave there, whatever lies on their way. Those that see it from
        // the inside only are met by their backward ends.
        const PixelSpan leaving = sign > 0 ? spans.left : spans.right;
        for (int x = leaving.begin; x < leaving.end; ++x)
            counts_[std::size_t(row) * std::size_t(frame_.width) + std::size_t(x)] += polygon.layers;
    } else if (polygon.kind == VolumePolygon::Kind::Side) {
        add_side(polygon, row, spans.left, sign);
        add_side(polygon, row, spans.right, -sign);
    } else {
        add_cap(polygon, row, spans.left, sign);
        add_cap(polygon, row, spans.right, -sign);
    }
}

/// The ray meets the polygon's plane within it; behind the receiver iff it comes from the receiver's side of the plane.
void VolumeCounter::add_side(const VolumePolygon& polygon, int row, PixelSpan span, int sign) {
    const glm::dvec3 n = double(sign) * polygon.outward;
    const double offset = sign * polygon.offset;
    const std::int32_t layers = sign * polygon.layers;
    const std::size_t first = std::size_t(row) * std::size_t(frame_.width);
    const double *x = x_.data() + first, *y = y_.data() + first, *z = z_.data() + first;
    std::int32_t* counts = counts_.data() + first;
    for (int i = span.begin; i < span.end; ++i)
        counts[i] += n.x * x[i] + n.y * y[i] + n.z * z[i] + offset < 0 ? layers : 0;
}

/// Receivers in the cap's plane count as if they lay a touch towards the light, so that no triangle shadows itself.
void VolumeCounter::add_cap(const VolumePolygon& polygon, int row, PixelSpan span, int sign) {
    const glm::dvec3& n = polygon.outward;
    const double reach = (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) * greatest_rel_;
    const double tolerance = kDoubleError * (polygon.tolerance + reach);
    const std::size_t first = std::size_t(row) * std::size_t(frame_.width);
    for (int i = span.begin; i < span.end; ++i) {
        const std::size_t pixel = first + std::size_t(i);
        const double height = n.x * x_[pixel] + n.y * y_[pixel] + n.z * z_[pixel] + polygon.offset;
        const bool outside = height > -tolerance || is_own_plane(polygon, pixel);
        if (outside == (sign < 0)) counts_[pixel] += sign * polygon.layers;
    }
}

/// Is the cap the receiver's own triangle, or one in its plane that shares an edge with it? The rule of OcclusionRule
/// by welded vertices, since it is asked for every pixel of a cap.
bool VolumeCounter::is_own_plane(const VolumePolygon& polygon, std::size_t pixel) const {
    const PixelIds& ids = frame_.ids[pixel];
    if (ids.instance != polygon.ids.instance) return false;
    if (ids.triangle == polygon.ids.triangle) return true;
    const Instance& instance = frame_.scene->instances[ids.instance];
    const Mesh& mesh = *frame_.scene->meshes[instance.mesh];
    const std::vector<std::uint32_t>& weld = edges_.at(instance.mesh).adjacency->weld;
    int shared = 0;
    std::uint32_t apex = kNoVertex;
    for (int k = 0; k < 3; ++k) {
        const std::uint32_t corner = weld[mesh.triangles[ids.triangle][k]];
        if (std::find(polygon.weld.begin(), polygon.weld.end(), corner) != polygon.weld.end())
            ++shared;
        else
            apex = corner;
    }
    if (shared != 2) return shared == 3;
    const glm::dmat3 linear(instance.world_from_object);
    const glm::dvec3 along = linear * (glm::dvec3(mesh.positions[apex]) - glm::dvec3(mesh.positions[polygon.weld[0]]));
    return std::abs(glm::dot(polygon.outward, along)) <=
           kFlatTolerance * glm::length(polygon.outward) * glm::length(along);
}

}  // namespace shadow_layers
