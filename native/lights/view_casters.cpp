// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/view_casters.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/thread_pool.h"
#include "scene/bounds.h"

namespace shadow_layers {

namespace {

constexpr std::size_t kInstanceBlock = 1 << 10;

/// A mesh's box in the view's light space: middle and half edges.
struct OrientedBox {
    glm::dvec3 middle;
    glm::dmat3 half;

    OrientedBox(const Bounds& bounds, const glm::dmat4& ls_from_object) {
        const glm::dvec3 size = 0.5 * (bounds.max - bounds.min);
        middle = glm::dvec3(ls_from_object * glm::dvec4(0.5 * (bounds.min + bounds.max), 1));
        for (int i = 0; i < 3; ++i) half[i] = size[i] * glm::dvec3(ls_from_object[i]);
    }
    /// Largest and smallest value of dot(normal, p) over the box.
    Interval span(const glm::dvec3& normal) const {
        const double centre = glm::dot(normal, middle);
        const double half_extent = std::abs(glm::dot(normal, half[0])) + std::abs(glm::dot(normal, half[1])) +
                                   std::abs(glm::dot(normal, half[2]));
        return {centre - half_extent, centre + half_extent};
    }
    glm::dvec3 corner(int k) const {
        return middle + (k & 1 ? half[0] : -half[0]) + (k & 2 ? half[1] : -half[1]) + (k & 4 ? half[2] : -half[2]);
    }
};

/// The four sides of the region as (normal, offset): inside where dot(normal, p) >= offset.
struct Side {
    glm::dvec3 normal;
    double offset;
};

std::array<Side, 4> find_sides(const ViewRegion& region) {
    if (!region.perspective)
        return {{{{1, 0, 0}, region.u.low},
                 {{-1, 0, 0}, -region.u.high},
                 {{0, 1, 0}, region.v.low},
                 {{0, -1, 0}, -region.v.high}}};
    // x >= u depth with depth = -z is x + u z >= 0
    return {{{{1, 0, region.u.low}, 0},
             {{-1, 0, -region.u.high}, 0},
             {{0, 1, region.v.low}, 0},
             {{0, -1, -region.v.high}, 0}}};
}

bool touches(const OrientedBox& box, const ViewRegion& region, const std::array<Side, 4>& sides) {
    const Interval z = box.span({0, 0, 1});
    if (-z.high >= region.depth_max || (region.perspective && -z.low <= 0)) return false;
    return std::all_of(sides.begin(), sides.end(),
                       [&](const Side& side) { return box.span(side.normal).high >= side.offset; });
}

/// Keeps the part of a convex polygon on the inner side (Sutherland and Hodgman).
void clip(std::vector<glm::dvec3>& polygon, const Side& side, std::vector<glm::dvec3>& scratch) {
    scratch.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double at_p = glm::dot(side.normal, p) - side.offset, at_q = glm::dot(side.normal, q) - side.offset;
        if (at_p >= 0) scratch.push_back(p);
        if ((at_p >= 0) != (at_q >= 0)) scratch.push_back(p + (at_p / (at_p - at_q)) * (q - p));
    }
    polygon.swap(scratch);
}

/// Is the light, at the origin, between the planes of all three pairs of faces?
bool holds_light(const OrientedBox& box) {
    for (int i = 0; i < 3; ++i) {
        const Interval across = box.span(glm::cross(box.half[(i + 1) % 3], box.half[(i + 2) % 3]));
        if (across.low > 0 || across.high < 0) return false;
    }
    return true;
}

/// Depth of the nearest point of the box inside the region; 0 if a pyramid starts in the box.
double find_nearest_depth(const OrientedBox& box, const ViewRegion& region, const std::array<Side, 4>& sides) {
    if (region.perspective && holds_light(box)) return 0;
    static constexpr int kFaces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
    double nearest = region.depth_max;
    std::vector<glm::dvec3> polygon, scratch;
    for (const auto& face : kFaces) {
        polygon.clear();
        for (const int k : face) polygon.push_back(box.corner(k));
        for (const Side& side : sides) clip(polygon, side, scratch);
        for (const glm::dvec3& p : polygon) nearest = std::min(nearest, -p.z);
    }
    return region.perspective ? std::max(nearest, 0.0) : nearest;
}

}  // namespace

ViewCasters find_view_casters(const Scene& scene, const Light& light, const ViewRegion& region, ThreadPool* threads) {
    const std::size_t count = scene.instances.size();
    const std::array<Side, 4> sides = find_sides(region);
    std::vector<ViewCasters> parts((count + kInstanceBlock - 1) / kInstanceBlock);
    const auto find = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            ViewCasters& part = parts[i / kInstanceBlock];
            if (i % kInstanceBlock == 0) part.nearest = region.depth_max;
            const Instance& instance = scene.instances[i];
            const Bounds& bounds = scene.meshes[instance.mesh]->bounds;
            if (!casts_for(light, instance)) continue;
            if (bounds.is_empty()) continue;
            const OrientedBox box(bounds, region.ls_from_ws * instance.world_from_object);
            if (!touches(box, region, sides)) continue;
            part.instances.push_back(std::uint32_t(i));
            if (-box.span({0, 0, 1}).high < part.nearest)
                part.nearest = std::min(part.nearest, find_nearest_depth(box, region, sides));
        }
    };
    if (threads)
        threads->parallel_for(count, kInstanceBlock, find);
    else
        find(0, count);
    ViewCasters all;
    all.nearest = region.depth_max;
    for (const ViewCasters& part : parts) {
        all.instances.insert(all.instances.end(), part.instances.begin(), part.instances.end());
        all.nearest = std::min(all.nearest, part.nearest);
    }
    return all;
}

}  // namespace shadow_layers
