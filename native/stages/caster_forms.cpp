// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/caster_forms.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/bounds.h"

namespace shadow_layers {
namespace {

using tile_kernel::CasterTriangle;

// Of a sum of a few products in double, each taken by its magnitude.
constexpr double kDoubleError = 8e-15;
// Corners this much nearer to the light's plane than the farthest one are not divided by w.
constexpr double kLeastDepthRatio = 1e-9;

/// Clip coordinates: (x, y, w) as the edge functions take them, and z.
struct ClipCorner {
    glm::dvec3 xyw;
    double z;
};

double sum_abs(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

void set_tile_range(double low, double high, int side, int& begin, int& end) {
    begin = std::clamp(int(std::floor(std::clamp((low + 1) * 0.5 * side, 0.0, double(side)))), 0, side);
    end = std::clamp(int(std::floor(std::clamp((high + 1) * 0.5 * side, -1.0, double(side)))) + 1, 0, side);
}

/// Are all corners beyond one side of the view's pyramid? Also right for corners behind the light.
bool is_outside(const ClipCorner (&corners)[3], double margin) {
    for (int axis = 0; axis < 2; ++axis)
        for (const double sign : {-1.0, 1.0})
            if (std::all_of(std::begin(corners), std::end(corners), [&](const ClipCorner& c) {
                    return sign * c.xyw[axis] > c.xyw.z + margin * std::abs(c.xyw.z);
                }))
                return true;
    return false;
}

/// Tiles and greatest depth. A triangle that reaches behind the light may touch all tiles.
bool set_extent(const ClipCorner (&corners)[3], int side, double margin, CasterTriangle& t) {
    t.column_begin = t.row_begin = 0;
    t.column_end = t.row_end = side;
    t.greatest_depth = std::numeric_limits<double>::infinity();
    const auto [least, most] = std::minmax({corners[0].xyw.z, corners[1].xyw.z, corners[2].xyw.z});
    if (!(most > 0) || is_outside(corners, margin)) return false;
    if (!(least > kLeastDepthRatio * most)) return true;
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    t.greatest_depth = -t.greatest_depth;
    for (const ClipCorner& c : corners) {
        const glm::dvec2 place = glm::dvec2(c.xyw) / c.xyw.z;
        low = glm::min(low, place);
        high = glm::max(high, place);
        t.greatest_depth = std::max(t.greatest_depth, c.z / c.xyw.z);
    }
    set_tile_range(low.x - margin, high.x + margin, side, t.column_begin, t.column_end);
    set_tile_range(low.y - margin, high.y + margin, side, t.row_begin, t.row_end);
    return t.column_begin < t.column_end && t.row_begin < t.row_end;
}

/// For q = (x, y, 1) and corners a, b, c as (x, y, w): det q = (q . b x c) a + (q . c x a) b + (q . a x b) c with
/// det = a . b x c. The light's ray through q meets the triangle iff all three factors have det's sign, and z / w there
/// is the corners' z weighted by them. Nothing is divided by w, so corners behind the light need no clipping.
bool set_forms(const ClipCorner (&corners)[3], CasterTriangle& t) {
    t.depth = {0, 0, 0};
    t.depth_error = 0;
    const double det = glm::dot(corners[0].xyw, glm::cross(corners[1].xyw, corners[2].xyw));
    if (!(std::abs(det) > 0) || !std::isfinite(det)) return false;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 &p = corners[(i + 1) % 3].xyw, &q = corners[(i + 2) % 3].xyw;
        const glm::dvec3 normal = (det > 0 ? 1.0 : -1.0) * glm::cross(p, q);
        const double z = corners[i].z / std::abs(det);
        t.edges[i] = {normal.z, normal.x, normal.y};
        t.edge_error[i] = kDoubleError * sum_abs(p) * sum_abs(q);
        t.depth.at_origin += normal.z * z;
        t.depth.by_x += normal.x * z;
        t.depth.by_y += normal.y * z;
        t.depth_error += t.edge_error[i] * std::abs(z);
    }
    return true;
}

/// Is there a receiver in the tiles? Only a few tiles are worth looking at.
bool may_meet_receivers(const CasterTriangle& t, int side, const std::uint32_t* receivers_in_tile) {
    constexpr int kFewTiles = 16;
    if (!receivers_in_tile || (t.column_end - t.column_begin) * (t.row_end - t.row_begin) > kFewTiles) return true;
    for (int row = t.row_begin; row < t.row_end; ++row)
        for (int column = t.column_begin; column < t.column_end; ++column)
            if (receivers_in_tile[std::size_t(row) * std::size_t(side) + std::size_t(column)] > 0) return true;
    return false;
}

}  // namespace

CasterRow::CasterRow(const Scene& scene, const LightView& view) : scene_(scene), view_(view) {
    std::size_t total = 0;
    for (const std::uint32_t index : view.casters) {
        const Instance& instance = scene.instances[index];
        first_.push_back(total);
        lc_from_object_.push_back(view.lc_from_ws * instance.world_from_object);
        total += scene.meshes[instance.mesh]->triangles.size();
    }
    first_.push_back(total);
}

bool CasterRow::set_up(std::size_t number, int side, double margin, CasterTriangle& t,
                       const std::uint32_t* receivers_in_tile) const {
    const std::size_t caster = std::size_t(std::upper_bound(first_.begin(), first_.end(), number) - first_.begin()) - 1;
    t.instance = view_.casters[caster];
    t.triangle = std::uint32_t(number - first_[caster]);
    const Mesh& mesh = *scene_.meshes[scene_.instances[t.instance].mesh];
    ClipCorner corners[3];
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& position = mesh.positions[mesh.triangles[t.triangle][k]];
        if (!is_usable_vertex(position)) return false;
        const glm::dvec4 lc = lc_from_object_[caster] * glm::dvec4(position, 1.0);
        corners[k] = {{lc.x, lc.y, lc.w}, lc.z};
    }
    return set_extent(corners, side, margin, t) && may_meet_receivers(t, side, receivers_in_tile) &&
           set_forms(corners, t);
}

}  // namespace shadow_layers
