// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/plane_shadow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace shadow_layers::truth {
namespace {

constexpr double kNoArea = 1e-9;  // of the square

/// The pixel's square in a picture: u = across / ahead and v = up / ahead are from -1/2 to 1/2 in it.
struct Square {
    Linear across{0.0}, up{0.0}, ahead{0.0};

    std::array<Linear, 4> sides() const {
        return {0.5 * ahead - across, 0.5 * ahead + across, 0.5 * ahead - up, 0.5 * ahead + up};
    }
    /// What is left of a triangle inside of the half-spaces, in the square.
    ConvexPolygon project(const std::vector<glm::dvec3>& corners) const {
        ConvexPolygon polygon;
        for (const glm::dvec3& corner : corners) {
            const double w = evaluate(ahead, corner);
            if (w > 0) polygon.add(glm::dvec2(evaluate(across, corner), evaluate(up, corner)) / w);
        }
        return polygon;
    }
};

std::vector<glm::dvec3> clip(const Corners& triangle, const std::vector<Linear>& half_spaces) {
    std::vector<glm::dvec3> corners(triangle.begin(), triangle.end()), part;
    for (const Linear& half_space : half_spaces) {
        part.clear();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3 &here = corners[i], &next = corners[(i + 1) % corners.size()];
            const double at = evaluate(half_space, here), then = evaluate(half_space, next);
            if (at >= 0) part.push_back(here);
            if ((at < 0 && then > 0) || (at > 0 && then < 0)) part.push_back(here + (next - here) * (at / (at - then)));
        }
        corners.swap(part);
    }
    return corners;
}

/// Of a function of points about `origin` that of points about zero.
Linear move_to_zero(Linear function, const glm::dvec3& origin) {
    function.w -= glm::dot(glm::dvec3(function), origin);
    return function;
}

}  // namespace

/// The plane that a pixel's centre sees. Points "_p" are relative to `origin`, the point that it sees of it.
struct PlaneShadows::Facet {
    glm::dvec3 origin{0.0};              ///< relative to the oracle's
    glm::dvec3 normal{0.0};              ///< unit, towards the camera
    Square square;                       ///< of points seen by the camera
    Linear depth{0.0};                   ///< view depth
    std::array<glm::dvec3, 4> square_p;  ///< where rays through the square's corners meet the plane

    bool holds(const Corners& corners_p) const { return lies_in_plane(corners_p, glm::dvec3(0), normal); }
    /// Calls visit(ids, corners_p) for the triangles near the common part of the half-spaces.
    template <class Visit>
    void find(const TriangleTree& tree, std::vector<Linear> half_spaces, const Visit& visit) const {
        for (Linear& half_space : half_spaces) half_space = move_to_zero(half_space, origin);
        tree.find(half_spaces, [&](const TriangleTree::Triangle& triangle) {
            Corners corners_p = triangle.corners;
            for (glm::dvec3& corner : corners_p) corner -= origin;
            visit(triangle.ids, corners_p);
        });
    }
};

PlaneShadows::PlaneShadows(const RayOracle& oracle, const TriangleTree& tree, const Frame& frame, const Light& light,
                           const LightSample& position)
    : oracle_(oracle),
      tree_(tree),
      frame_(frame),
      light_(light),
      position_(position),
      rule_(*frame.scene, light, position) {}

std::optional<PlaneShadows::Facet> PlaneShadows::find_facet(std::size_t pixel) const {
    const auto receiver = oracle_.find_receiver(frame_, pixel);
    if (!receiver || rule_.find_standing(*receiver) != Standing::Facing) return std::nullopt;
    const Camera& camera = frame_.camera;
    const double column = double(pixel % std::size_t(frame_.width)), row = double(pixel / std::size_t(frame_.width));
    const auto make_ray = [&](double x, double y) {
        return compute_pixel_ray(camera, column + x, row + y, frame_.width, frame_.height);
    };
    const PixelRay centre = make_ray(0.5, 0.5);
    const auto distance = oracle_.meet_plane(centre, frame_.ids[pixel]);
    if (!distance) return std::nullopt;
    const glm::dvec3 point_ws = centre.origin_ws + *distance * centre.direction;
    Facet facet;
    facet.origin = point_ws - oracle_.get_origin();
    facet.normal = receiver->normal;
    for (int k = 0; k < 4; ++k) {
        const PixelRay ray = make_ray(k & 1, k >> 1);
        const auto at = oracle_.meet_plane(ray, frame_.ids[pixel]);
        if (!at || (camera.perspective && *at <= 0)) return std::nullopt;
        facet.square_p[std::size_t(k)] = ray.origin_ws - point_ws + *at * ray.direction;
    }
    // The facet's origin is the pixel's centre: both coordinates are 0 there.
    const glm::dmat3 axes(camera.world_from_camera);
    const glm::dvec2 pixel_size =
        glm::dvec2(camera.window.right - camera.window.left, camera.window.top - camera.window.bottom) /
        glm::dvec2(frame_.width, frame_.height);
    facet.depth = Linear(-axes[2], *distance);
    facet.square.ahead = camera.perspective ? facet.depth : Linear(0, 0, 0, 1);
    const glm::dvec3 view = camera.perspective ? centre.direction : glm::dvec3(0);
    for (const int axis : {0, 1}) {
        const glm::dvec3 sideways = axes[axis] + axes[2] * glm::dot(axes[axis], view);
        (axis == 0 ? facet.square.across : facet.square.up) = Linear(sideways / pixel_size[axis], 0);
    }
    return facet;
}

bool PlaneShadows::is_in_cone(const Facet& facet) const {
    return std::all_of(facet.square_p.begin(), facet.square_p.end(), [&](const glm::dvec3& corner) {
        return rule_.is_in_cone(corner + facet.origin + oracle_.get_origin());
    });
}

bool PlaneShadows::may_cast(const PixelIds& ids) const {
    return truth::may_cast(light_, frame_.scene->instances[ids.instance]);
}

std::optional<double> PlaneShadows::find_lit_part(std::size_t pixel) const {
    const auto facet = find_facet(pixel);
    if (!facet || !is_in_cone(*facet)) return std::nullopt;
    if (!light_.casts_shadow) return 1;
    const glm::dvec3 light_p =
        position_.directional ? position_.to_light_ws : position_.position_ws - oracle_.get_origin() - facet->origin;
    const double height = glm::dot(facet->normal, light_p);
    if (!(height > 0)) return std::nullopt;
    // A point X at the height h over the plane is cast to P = (X height - L h) / (height - h); of a sun, P = X - L h /
    // height. A function of P, times that denominator by height, is this one of X.
    const auto carry = [&](const Linear& of_point) {
        const double weight = glm::dot(glm::dvec3(of_point), light_p) + (position_.directional ? 0 : of_point.w);
        return Linear(glm::dvec3(of_point) - facet->normal * (weight / height), of_point.w);
    };
    const Square square{carry(facet->square.across), carry(facet->square.up), carry(facet->square.ahead)};
    const auto sides = square.sides();
    std::vector<Linear> shadowing(sides.begin(), sides.end());
    shadowing.push_back(Linear(facet->normal, 0));
    if (!position_.directional) shadowing.push_back(Linear(-facet->normal, height));
    std::vector<ConvexPolygon> shadows;
    facet->find(tree_, shadowing, [&](const PixelIds& ids, const Corners& corners_p) {
        if (!may_cast(ids) || facet->holds(corners_p)) return;
        const ConvexPolygon shadow = square.project(clip(corners_p, shadowing));
        if (shadow.size() > 2) shadows.push_back(shadow);
    });
    // What rounding leaves must not make a pixel of the border.
    const double shadow = compute_union_area(shadows, {});
    return shadow <= kNoArea ? 1 : shadow >= 1 - kNoArea ? 0 : 1 - shadow;
}

bool PlaneShadows::sees_plane_alone(std::size_t pixel) const {
    const auto facet = find_facet(pixel);
    if (!facet) return false;
    for (const glm::dvec3& corner : facet->square_p) {
        const double depth = evaluate(facet->depth, corner);
        if (depth < frame_.camera.clip_start || depth > frame_.camera.clip_end) return false;
    }
    const auto sides = facet->square.sides();
    std::vector<Linear> seen(sides.begin(), sides.end());
    std::vector<Linear> before = seen;
    before.push_back(Linear(facet->normal, 0));
    before.push_back(facet->depth - Linear(0, 0, 0, frame_.camera.clip_start));
    // The plane itself must be found too, whatever side of it rounding puts its triangles on.
    std::vector<Linear> near = seen;
    near.push_back(Linear(facet->normal, glm::length(facet->square_p[3] - facet->square_p[0])));
    bool alone = true;
    std::vector<ConvexPolygon> covers;
    facet->find(tree_, near, [&](const PixelIds& ids, const Corners& corners_p) {
        const std::uint32_t flags = frame_.scene->instances[ids.instance].flags;
        if (!alone || !(flags & kInstanceCamera)) return;
        if (facet->holds(corners_p)) {
            const ConvexPolygon cover = facet->square.project(clip(corners_p, seen));
            if (!(cover.compute_area() > kNoArea)) return;
            alone = !(flags & kInstanceHoldout) && rule_.is_linked(ids.instance);
            covers.push_back(cover);
        } else {
            alone = facet->square.project(clip(corners_p, before)).compute_area() <= kNoArea;
        }
    });
    return alone && compute_union_area(covers, {}) >= 1 - kNoArea;
}

}  // namespace shadow_layers::truth
