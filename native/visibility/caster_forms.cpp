// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/caster_forms.h"

#include <algorithm>
#include <cmath>

#include "scene/bounds.h"

namespace shadow_layers {
namespace {

using tile_kernel::CasterTriangle;

// Of a sum of a few products in double, each taken by its magnitude.
constexpr double kDoubleError = 8e-15;
// Tiles that a triangle may touch and that are worth looking at before it is set up.
constexpr int kFewTiles = 16;

/// False if a corner can't be used.
bool make_corners(const Mesh& mesh, std::uint32_t triangle, const glm::dmat4& lc_from_object,
                  ClipCorner (&corners)[3]) {
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& position = mesh.positions[mesh.triangles[triangle][k]];
        if (!is_usable_vertex(position)) return false;
        corners[k] = project_corner(lc_from_object, glm::dvec3(position));
    }
    return true;
}

double sum_abs(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// For q = (x, y, 1) and corners a, b, c as (x, y, w): det q = (q . b x c) a + (q . c x a) b + (q . a x b) c with
/// det = a . b x c. The light's ray through q meets the triangle iff all three factors have det's sign, and z / w there
/// is the corners' z weighted by them. Nothing is divided by w, so corners behind the light need no clipping.
bool set_forms(const ClipCorner (&corners)[3], CasterTriangle& t) {
    const double det = glm::dot(corners[0].xyw, glm::cross(corners[1].xyw, corners[2].xyw));
    if (!(std::abs(det) > 0) || !std::isfinite(det)) return false;
    const double sign = det > 0 ? 1.0 : -1.0, over_det = 1 / std::abs(det);
    t.at[3] = t.by_x[3] = t.by_y[3] = t.error[3] = 0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 &p = corners[(i + 1) % 3].xyw, &q = corners[(i + 2) % 3].xyw;
        const glm::dvec3 normal = sign * glm::cross(p, q);
        const double z = corners[i].z * over_det;
        t.at[i] = normal.z, t.by_x[i] = normal.x, t.by_y[i] = normal.y;
        t.error[i] = kDoubleError * sum_abs(p) * sum_abs(q);
        t.at[3] += normal.z * z;
        t.by_x[3] += normal.x * z;
        t.by_y[3] += normal.y * z;
        t.error[3] += t.error[i] * std::abs(z);
    }
    return true;
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

std::size_t CasterRow::set_up(std::size_t begin, std::size_t end, const CasterGrid& grid,
                              CasterTriangle* triangles) const {
    std::size_t caster = std::size_t(std::upper_bound(first_.begin(), first_.end(), begin) - first_.begin()) - 1;
    CasterTriangle* next = triangles;
    for (std::size_t number = begin; number < end; ++caster) {
        const std::uint32_t instance = view_.casters[caster];
        const Mesh& mesh = *scene_.meshes[scene_.instances[instance].mesh];
        const glm::dmat4& lc_from_object = lc_from_object_[caster];
        for (const std::size_t stop = std::min(end, first_[caster + 1]); number < stop; ++number) {
            CasterTriangle& t = *next;
            t.instance = instance;
            t.triangle = std::uint32_t(number - first_[caster]);
            ClipCorner corners[3];
            if (make_corners(mesh, t.triangle, lc_from_object, corners) && find_extent(corners, grid, t.extent) &&
                may_meet_receivers(t.extent, grid, kFewTiles) && set_forms(corners, t))
                ++next;
        }
    }
    return std::size_t(next - triangles);
}

}  // namespace shadow_layers
