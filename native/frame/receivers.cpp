// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/receivers.h"

#include <algorithm>

namespace shadow_layers {
namespace {

constexpr std::size_t kRowsPerBlock = 8;
// A fragment may lie a fraction of a pixel outside its triangle (the raster's grid is 1/256 pixel), so its depth may
// pass those of the corners a little and still be right.
constexpr double kDepthSlack = 0.05;

bool is_same(const PixelIds& a, const PixelIds& b) { return a.instance == b.instance && a.triangle == b.triangle; }

/// One row's rays; parameter x in pixels.
struct RowRays {
    glm::dvec3 origin, origin_dx, direction, direction_dx;
};

struct Run {
    std::size_t row_begin;  ///< index of the row's first pixel
    int begin, end;         ///< pixels of the row
};

// Pixels worked at once: short enough for small faces, long enough for the widest registers.
constexpr int kLane = 16;

/// Positions of a few pixels, one array per axis, so that the arithmetic vectorises.
struct Lane {
    float x[kLane], y[kLane], z[kLane];
};

/// p = o(x) + d(x) * (distance - n.o(x)) / n.d(x), everything linear in the pixel's place x but for the division.
struct RunSolver {
    glm::dvec3 origin, origin_dx, direction, direction_dx;
    double above, above_dx, slope, slope_dx, low, high;

    RunSolver(const TrianglePlane& plane, const RowRays& rays, double clip_start)
        : origin(rays.origin),
          origin_dx(rays.origin_dx),
          direction(rays.direction),
          direction_dx(rays.direction_dx),
          above(plane.distance - glm::dot(plane.normal, rays.origin)),
          above_dx(-glm::dot(plane.normal, rays.origin_dx)),
          slope(glm::dot(plane.normal, rays.direction)),
          slope_dx(glm::dot(plane.normal, rays.direction_dx)) {
        const double slack = kDepthSlack * (plane.far_vs - plane.near_vs);
        low = std::max(plane.near_vs - slack, clip_start);
        high = plane.far_vs + slack;
    }

    void solve(int first, int count, Lane& lane) const {
        for (int i = 0; i < count; ++i) {
            const double x = (first + i) + 0.5;
            double depth = (above + above_dx * x) / (slope + slope_dx * x);
            depth = depth > low ? depth : low;  // also for 0/0
            depth = depth < high ? depth : high;
            lane.x[i] = float(origin.x + x * origin_dx.x + depth * (direction.x + x * direction_dx.x));
            lane.y[i] = float(origin.y + x * origin_dx.y + depth * (direction.y + x * direction_dx.y));
            lane.z[i] = float(origin.z + x * origin_dx.z + depth * (direction.z + x * direction_dx.z));
        }
    }
};

void resolve_positions(const TrianglePlane& plane, const RowRays& rays, const Run& run, Frame& frame,
                       const ReceiverTexels& texels) {
    const RunSolver solver(plane, rays, frame.camera.clip_start);
    for (int first = run.begin; first < run.end; first += kLane) {
        const int count = std::min(kLane, run.end - first);
        Lane lane;
        solver.solve(first, count, lane);
        const std::size_t pixel = run.row_begin + std::size_t(first);
        glm::vec3* positions = frame.positions_rel.data() + pixel;
        glm::vec4* position_texels = texels.positions.data() + pixel;
        for (int i = 0; i < count; ++i) {
            positions[i] = glm::vec3(lane.x[i], lane.y[i], lane.z[i]);
            position_texels[i] = glm::vec4(lane.x[i], lane.y[i], lane.z[i], 1.0f);
        }
    }
}

void fill_empty(const Run& run, Frame& frame, const ReceiverTexels& texels) {
    const auto fill = [&](auto& values, auto value) {
        std::fill(values.begin() + std::ptrdiff_t(run.row_begin) + run.begin,
                  values.begin() + std::ptrdiff_t(run.row_begin) + run.end, value);
    };
    fill(frame.positions_rel, glm::vec3(0.0f));
    fill(frame.normals, glm::vec3(0.0f));
    fill(frame.coverage, std::uint8_t(0));
    fill(texels.positions, glm::vec4(0.0f));
    fill(texels.normals, glm::vec4(0.0f));
}

void fill_run(const Run& run, const PixelIds& ids, const RowRays& rays, Frame& frame, const ReceiverTexels& texels) {
    if (ids.instance == kNoId || (frame.scene->instances[ids.instance].flags & kInstanceHoldout)) {
        fill_empty(run, frame, texels);
        return;
    }
    TrianglePlane plane = compute_triangle_plane(*frame.scene, ids, frame.camera);
    if (plane.normal == glm::dvec3(0.0)) {
        // No area, yet a fragment: face it to the ray through the run's middle, at the corners' depth.
        const double x = 0.5 * (run.begin + run.end);
        plane.normal = -glm::normalize(rays.direction + x * rays.direction_dx);
        plane.distance = glm::dot(
            plane.normal, rays.origin + x * rays.origin_dx + plane.near_vs * (rays.direction + x * rays.direction_dx));
    }
    resolve_positions(plane, rays, run, frame, texels);
    const glm::vec3 normal(plane.normal);
    const float group = float(frame.scene->instances[ids.instance].receiver_group);
    for (int i = run.begin; i < run.end; ++i) {
        const std::size_t pixel = run.row_begin + std::size_t(i);
        frame.normals[pixel] = normal;
        frame.coverage[pixel] = 1;
        texels.normals[pixel] = glm::vec4(normal, group);
    }
}

void resolve_row(const RayBasis& basis, int y, Frame& frame, const ReceiverTexels& texels) {
    const double y_px = y + 0.5;
    const RowRays rays{basis.origin_0 + y_px * basis.origin_dy, basis.origin_dx,
                       basis.direction_0 + y_px * basis.direction_dy, basis.direction_dx};
    const std::size_t row_begin = std::size_t(y) * std::size_t(frame.width);
    const PixelIds* row = frame.ids.data() + row_begin;
    for (int begin = 0, end = 0; begin < frame.width; begin = end) {
        while (end < frame.width && is_same(row[end], row[begin])) ++end;
        fill_run({row_begin, begin, end}, row[begin], rays, frame, texels);
    }
}

}  // namespace

TrianglePlane compute_triangle_plane(const Scene& scene, const PixelIds& ids, const Camera& camera) {
    const Instance& instance = scene.instances[ids.instance];
    const Mesh& mesh = *scene.meshes[instance.mesh];
    const glm::uvec3& triangle = mesh.triangles[ids.triangle];
    const glm::dvec3 origin(camera.world_from_camera[3]), forward(-glm::dvec3(camera.world_from_camera[2]));
    const glm::dmat3 linear(instance.world_from_object);
    const glm::dvec3 offset = glm::dvec3(instance.world_from_object[3]) - origin;
    const glm::dvec3 a(mesh.positions[triangle.x]), b(mesh.positions[triangle.y]), c(mesh.positions[triangle.z]);
    const glm::dvec3 corner_rel = linear * a + offset;
    // Edges from differences in object space: the large offsets of far places never enter.
    const glm::dvec3 edge_b = linear * (b - a), edge_c = linear * (c - a);
    TrianglePlane plane;
    const glm::dvec3 area = glm::cross(edge_b, edge_c);
    // Scaled first: the squares of tiny areas would underflow.
    const double largest = std::max({std::abs(area.x), std::abs(area.y), std::abs(area.z)});
    if (largest > 0) plane.normal = glm::normalize(area / largest);
    plane.distance = glm::dot(plane.normal, corner_rel);
    const bool is_turned_away = camera.perspective ? plane.distance > 0 : glm::dot(plane.normal, forward) > 0;
    if (is_turned_away) {
        plane.normal = -plane.normal;
        plane.distance = -plane.distance;
    }
    const double depth_a = glm::dot(corner_rel, forward);
    const double depth_b = depth_a + glm::dot(edge_b, forward), depth_c = depth_a + glm::dot(edge_c, forward);
    plane.near_vs = std::min({depth_a, depth_b, depth_c});
    plane.far_vs = std::max({depth_a, depth_b, depth_c});
    return plane;
}

void resolve_receivers(ThreadPool& threads, Frame& frame, const ReceiverTexels& texels) {
    const std::size_t count = frame.pixel_count();
    frame.positions_rel.resize(count);
    frame.normals.resize(count);
    frame.coverage.resize(count);
    const RayBasis basis(frame.camera, frame.width, frame.height);
    threads.parallel_for(std::size_t(frame.height), kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) resolve_row(basis, int(y), frame, texels);
    });
}

}  // namespace shadow_layers
