// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/ray_oracle.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include "scene/bounds.h"

namespace shadow_layers::truth {

namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon();

struct Triangle {
    Corners corners;
    PixelIds ids;
};

/// The surface that a receiver lies on.
struct Self {
    PixelIds ids;
    Corners corners;
    glm::dvec3 normal{0.0};  ///< unit
    bool leaves_plane_out = false;
};

/// What the callbacks need; Embree hands the first member back.
struct Query {
    RTCIntersectContext context;
    SightLine line;
    double near = 0, far = 1;  ///< in lengths of the way
    std::uint32_t flags = ~0u;
    const Light* light = nullptr;
    const Self* self = nullptr;
    double length = 1, ahead = 0;  ///< of the way; where the float ray starts, along it
    std::optional<RayHit> first;
    Sight sight;
    bool is_settled = false;  ///< blocked for certain
};

}  // namespace

struct RayOracle::Impl {
    std::shared_ptr<const Scene> scene;
    glm::dvec3 origin{0.0};
    double pad = 0, diameter = 0;
    std::vector<Triangle> triangles;
    std::vector<std::size_t> first_triangle;  ///< per instance
    RTCDevice device = nullptr;
    RTCScene embree = nullptr;

    bool counts(const Query& query, const Triangle& triangle) const {
        const Instance& instance = scene->instances[triangle.ids.instance];
        return query.light ? may_cast(*query.light, instance) : (instance.flags & query.flags) != 0;
    }

    /// Does the triangle block the query's line?
    Sight block(const Query& query, const Triangle& triangle) const {
        const Self& self = *query.self;
        if (triangle.ids.instance == self.ids.instance && triangle.ids.triangle == self.ids.triangle) return {};
        const Crossing crossing = cross_triangle(query.line, triangle.corners);
        if (!crossing.meets && crossing.certain) return {};
        const Neighbourhood near = find_neighbourhood(self.corners, triangle.corners, query.line.slack);
        if (near.is_own_surface && near.certain) return {};
        if (self.leaves_plane_out && lies_in_plane(triangle.corners, query.line.start, self.normal)) return {};
        return {crossing.meets && !near.is_own_surface, crossing.certain && near.certain};
    }

    static void bounds(const RTCBoundsFunctionArguments* args) {
        const auto& self = *static_cast<const Impl*>(args->geometryUserPtr);
        const Corners& c = self.triangles[args->primID].corners;
        const glm::dvec3 low = glm::min(c[0], glm::min(c[1], c[2])) - self.pad;
        const glm::dvec3 high = glm::max(c[0], glm::max(c[1], c[2])) + self.pad;
        *args->bounds_o = {float(low.x), float(low.y), float(low.z), 0, float(high.x), float(high.y), float(high.z), 0};
    }
    static void occluded(const RTCOccludedFunctionNArguments* args) {
        if (!args->valid[0]) return;
        const auto& self = *static_cast<const Impl*>(args->geometryUserPtr);
        auto& query = *reinterpret_cast<Query*>(args->context);
        const Triangle& triangle = self.triangles[args->primID];
        if (query.is_settled || !self.counts(query, triangle)) return;
        const Sight sight = self.block(query, triangle);
        query.is_settled = sight.blocked && sight.certain;
        query.sight.blocked = query.sight.blocked || sight.blocked;
        query.sight.certain = query.is_settled || (query.sight.certain && sight.certain);
        if (!query.is_settled) return;
        reinterpret_cast<RTCRay*>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
    }
    static void intersected(const RTCIntersectFunctionNArguments* args) {
        if (!args->valid[0]) return;
        const auto& self = *static_cast<const Impl*>(args->geometryUserPtr);
        auto& query = *reinterpret_cast<Query*>(args->context);
        const Triangle& triangle = self.triangles[args->primID];
        if (!self.counts(query, triangle)) return;
        const Crossing crossing = cross_triangle(query.line, triangle.corners);
        if (!crossing.meets || !(crossing.distance > query.near && crossing.distance < query.far)) return;
        query.far = crossing.distance;
        query.first = RayHit{triangle.ids, crossing.distance};
        reinterpret_cast<RTCRayHit*>(args->rayhit)->ray.tfar =
            float(crossing.distance * query.length - query.ahead + self.pad);
    }

    RTCRay make_ray(Query& query) const {
        const double length = query.length = glm::length(query.line.way);
        const glm::dvec3 unit = query.line.way / length;
        // A start far outside of the scene is moved along the ray to just before it, for the sake of float boxes.
        const double ahead = query.ahead =
            std::max(query.near * length, -glm::dot(query.line.start, unit) - diameter * 2);
        const glm::dvec3 start = query.line.start + ahead * unit;
        RTCRay ray{};
        ray.org_x = float(start.x), ray.org_y = float(start.y), ray.org_z = float(start.z);
        ray.dir_x = float(unit.x), ray.dir_y = float(unit.y), ray.dir_z = float(unit.z);
        ray.tnear = 0;
        ray.tfar = float(std::min(query.far * length - ahead + pad, 1e30));
        ray.mask = ~0u;
        return ray;
    }

    void add_triangles(std::uint32_t number) {
        const Instance& instance = scene->instances[number];
        const Mesh& mesh = *scene->meshes[instance.mesh];
        glm::dmat4 matrix = instance.world_from_object;
        matrix[3] -= glm::dvec4(origin, 0);
        first_triangle.push_back(triangles.size());
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            Triangle triangle;
            bool usable = true;
            for (int k = 0; k < 3; ++k) {
                const glm::vec3& p = mesh.positions[mesh.triangles[t][k]];
                usable = usable && is_usable_vertex(p);
                triangle.corners[std::size_t(k)] = glm::dvec3(matrix * glm::dvec4(p, 1));
            }
            if (!usable) triangle.corners = {};  // no area at the origin: met by no ray
            triangle.ids = {number, t};
            triangles.push_back(triangle);
        }
    }

    void build_tree() {
        device = rtcNewDevice(nullptr);
        if (!device) throw std::runtime_error("Embree made no device");
        embree = rtcNewScene(device);
        rtcSetSceneFlags(embree, RTC_SCENE_FLAG_ROBUST);
        const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, unsigned(triangles.size()));
        rtcSetGeometryUserData(geometry, this);
        rtcSetGeometryBoundsFunction(
            geometry, [](const RTCBoundsFunctionArguments* args) { bounds(args); }, nullptr);
        rtcSetGeometryOccludedFunction(geometry, &Impl::occluded);
        rtcSetGeometryIntersectFunction(geometry, &Impl::intersected);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(embree, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(embree);
    }
};

RayOracle::RayOracle(std::shared_ptr<const Scene> scene) : impl_(std::make_unique<Impl>()) {
    impl_->scene = std::move(scene);
    const Bounds bounds = compute_scene_bounds(*impl_->scene, ~0u);
    if (!bounds.is_empty()) {
        impl_->origin = 0.5 * (bounds.min + bounds.max);
        impl_->diameter = glm::length(bounds.max - bounds.min);
    }
    impl_->pad = 2e-6 * impl_->diameter;
    for (std::uint32_t i = 0; i < impl_->scene->instances.size(); ++i) impl_->add_triangles(i);
    impl_->build_tree();
}

RayOracle::~RayOracle() {
    rtcReleaseScene(impl_->embree);
    rtcReleaseDevice(impl_->device);
}

glm::dvec3 RayOracle::get_origin() const { return impl_->origin; }
const std::shared_ptr<const Scene>& RayOracle::get_scene() const { return impl_->scene; }

std::array<glm::dvec3, 3> RayOracle::get_corners(const PixelIds& ids) const {
    return impl_->triangles[impl_->first_triangle[ids.instance] + ids.triangle].corners;
}

std::optional<RayHit> RayOracle::find_first(const glm::dvec3& origin_ws, const glm::dvec3& direction, double near,
                                            double far, std::uint32_t flags) const {
    Query query;
    rtcInitIntersectContext(&query.context);
    query.line = {origin_ws - impl_->origin, direction, true, 0};
    query.near = near, query.far = far, query.flags = flags;
    RTCRayHit ray{};
    ray.ray = impl_->make_ray(query);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(impl_->embree, &query.context, &ray);
    return query.first;
}

Sight RayOracle::look(const Receiver& receiver, const Light& light, const LightSample& sample, OwnSurface own) const {
    Query query;
    rtcInitIntersectContext(&query.context);
    query.line.start = receiver.place_ws - impl_->origin;
    query.line.endless = sample.directional;
    query.line.way = sample.directional ? sample.to_light_ws * (4 * impl_->diameter + 1e-300)
                                        : sample.position_ws - receiver.place_ws;
    query.line.slack = receiver.slack;
    if (!sample.directional) query.line.slack += 8 * kRounding * glm::length(sample.position_ws);
    if (query.line.way == glm::dvec3(0)) return {false, false};
    query.light = &light;
    Self self{receiver.ids, get_corners(receiver.ids), glm::dvec3(0), own == OwnSurface::WholePlane};
    self.normal = glm::normalize(glm::cross(self.corners[1] - self.corners[0], self.corners[2] - self.corners[0]));
    query.self = &self;
    RTCRay ray = impl_->make_ray(query);
    rtcOccluded1(impl_->embree, &query.context, &ray);
    return query.sight;
}

bool RayOracle::is_occluded(const glm::dvec3& receiver_ws, const PixelIds& receiver, const Light& light,
                            const LightSample& sample, OwnSurface own) const {
    return look({receiver, receiver_ws, glm::dvec3(0), 0, 0, true}, light, sample, own).blocked;
}

std::optional<double> RayOracle::meet_plane(const PixelRay& ray, const PixelIds& ids) const {
    const std::array<glm::dvec3, 3> corners = get_corners(ids);
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double along = glm::dot(ray.direction, normal);
    if (along == 0) return std::nullopt;
    return glm::dot(corners[0] + (impl_->origin - ray.origin_ws), normal) / along;
}

}  // namespace shadow_layers::truth
