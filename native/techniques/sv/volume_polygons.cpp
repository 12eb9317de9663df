// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/sv/volume_polygons.h"

#include <cmath>
#include <utility>

#include "base/thread_pool.h"
#include "scene/bounds.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kVertexBlock = 1 << 13;

double sum_abs(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

}  // namespace

CasterVolumes::CasterVolumes(const Frame& frame, const LightSample& sample, const PictureSpace& picture,
                             std::uint32_t instance, const MeshEdges& edges, ThreadPool& threads)
    : mesh_(*frame.scene->meshes[frame.scene->instances[instance].mesh]),
      adjacency_(*edges.adjacency),
      picture_(picture),
      instance_(instance),
      directional_(sample.directional),
      light_rel_(directional_ ? sample.to_light_ws : sample.position_ws - frame.origin_ws),
      linear_(frame.scene->instances[instance].world_from_object),
      offset_rel_(glm::dvec3(frame.scene->instances[instance].world_from_object[3]) - frame.origin_ws) {
    const glm::dmat4& world_from_object = frame.scene->instances[instance].world_from_object;
    const LightPoint light = directional_ ? LightPoint(sample.to_light_ws, 0.0) : LightPoint(sample.position_ws, 1.0);
    light_in_object_ = compute_light_in_object(world_from_object, light);
    if (light_in_object_ == glm::dvec4(0)) return;  // flat as the light sees it
    silhouettes_ = find_silhouettes(mesh_, edges, world_from_object, light, {}, &threads);
    place_vertices(threads);
    find_sides(threads);
}

void CasterVolumes::place_vertices(ThreadPool& threads) {
    vertices_.resize(mesh_.positions.size());
    threads.parallel_for(vertices_.size(), kVertexBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            if (adjacency_.weld[v] != v || !is_usable_vertex(mesh_.positions[v])) continue;
            const glm::dvec3 rel = linear_ * glm::dvec3(mesh_.positions[v]) + offset_rel_;
            // The vertex v goes to (v w - l, 0): a sun sends all to the same place.
            const glm::dvec3 away = directional_ ? -light_rel_ : rel - light_rel_;
            vertices_[v] = {rel, picture_.project(rel, 1), picture_.project(away, 0)};
        }
    });
}

// As find_silhouettes decides, to the bit: at a triangle that is edge-on, sides and caps must go together.
void CasterVolumes::find_sides(ThreadPool& threads) {
    sides_of_triangles_.resize(mesh_.triangles.size());
    const glm::dvec3 towards(light_in_object_);
    threads.parallel_for(sides_of_triangles_.size(), kVertexBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            sides_of_triangles_[t] = kNone;
            if (adjacency_.component[t] == kNoVertex) continue;
            const glm::uvec3& corners = mesh_.triangles[t];
            const glm::dvec3 p(mesh_.positions[corners.x]);
            const glm::dvec3 normal =
                glm::cross(glm::dvec3(mesh_.positions[corners.y]) - p, glm::dvec3(mesh_.positions[corners.z]) - p);
            if (normal == glm::dvec3(0)) continue;
            const double side = glm::dot(towards - light_in_object_.w * p, normal);
            sides_of_triangles_[t] = side < 0 ? kAway : kFacing;
        }
    });
}

bool CasterVolumes::make(std::size_t number, VolumePolygon& polygon) const {
    if (number < side_count()) return make_side(silhouettes_[number], polygon);
    const std::size_t cap = number - side_count();
    const bool far = cap >= cap_count();
    return make_cap(std::uint32_t(far ? cap - cap_count() : cap), far, polygon);
}

PictureLine CasterVolumes::line_of_edge(std::uint32_t from, std::uint32_t to, bool far) const {
    const Vertex &p = vertices_[from], &q = vertices_[to];
    return PictureLine::make(far ? p.far : p.near, far ? q.far : q.near, from > to);
}

PictureLine CasterVolumes::line_of_extrusion(std::uint32_t vertex, bool towards_light) const {
    const Vertex& v = vertices_[vertex];
    return towards_light ? PictureLine::make(v.far, v.near, true) : PictureLine::make(v.near, v.far, false);
}

void CasterVolumes::set_plane(const glm::dvec3& normal, const glm::dvec3& point, VolumePolygon& polygon) const {
    polygon.outward = normal;
    polygon.offset = -glm::dot(normal, point);
    polygon.tolerance = sum_abs(normal) * sum_abs(point);
}

bool CasterVolumes::make_side(const SilhouetteEdge& edge, VolumePolygon& polygon) const {
    // Seen from the light, the caster is to the left of a -> b; so the side goes round b, a, a at infinity, b there.
    const Vertex &a = vertices_[edge.a], &b = vertices_[edge.b];
    const std::array<glm::dvec3, 4> corners{b.near, a.near, a.far, b.far};
    if (!find_pixel_box(std::span(corners).first(directional_ ? 3 : 4), picture_, polygon.box)) return false;
    polygon.kind = VolumePolygon::Kind::Side;
    polygon.layers = edge.multiplicity;
    polygon.lines[0] = line_of_edge(edge.b, edge.a, false);
    polygon.lines[1] = line_of_extrusion(edge.a, false);
    polygon.lines[2] = line_of_extrusion(edge.b, true);
    polygon.line_count = 3;
    if (!directional_) polygon.lines[polygon.line_count++] = line_of_edge(edge.a, edge.b, true);
    const glm::dvec3 away = directional_ ? -light_rel_ : a.rel - light_rel_;
    set_plane(glm::cross(a.rel - b.rel, away), a.rel, polygon);
    return true;
}

bool CasterVolumes::make_cap(std::uint32_t triangle, bool far, VolumePolygon& polygon) const {
    if (sides_of_triangles_[triangle] == kNone) return false;
    const glm::uvec3& stored = mesh_.triangles[triangle];
    std::array<std::uint32_t, 3> v{adjacency_.weld[stored.x], adjacency_.weld[stored.y], adjacency_.weld[stored.z]};
    // Caps are turned to the light, far caps away from it.
    if ((sides_of_triangles_[triangle] == kAway) != far) std::swap(v[1], v[2]);
    std::array<glm::dvec3, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = far ? vertices_[v[k]].far : vertices_[v[k]].near;
    if (!find_pixel_box(corners, picture_, polygon.box)) return false;
    polygon.kind = far ? VolumePolygon::Kind::FarCap : VolumePolygon::Kind::Cap;
    polygon.layers = 1;
    polygon.line_count = 3;
    for (int k = 0; k < 3; ++k) polygon.lines[k] = line_of_edge(v[k], v[(k + 1) % 3], far);
    polygon.ids = {instance_, triangle};
    polygon.weld = v;
    const glm::dvec3& p = vertices_[v[0]].rel;
    if (!far) set_plane(glm::cross(vertices_[v[1]].rel - p, vertices_[v[2]].rel - p), p, polygon);
    return true;
}

}  // namespace shadow_layers
