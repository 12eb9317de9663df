// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/ray_oracle.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/thread_pool.h"
#include "lights/facing.h"
#include "scene/bounds.h"
#include "truth/ray_triangle.h"

namespace shadow_layers::truth {

namespace {

struct Triangle {
    Corners corners;
    PixelIds ids;
};

/// What the callbacks need; Embree hands the first member back.
struct Query {
    RTCIntersectContext context;
    glm::dvec3 origin, direction;
    double near, far;
    std::uint32_t flags = ~0u;
    const Light* light = nullptr;
    PixelIds self;
    Corners self_corners;
    bool has_self = false, leaves_plane_out = false;
    glm::dvec3 self_normal{0.0};
    double length = 1, ahead = 0;  ///< of the direction; where the float ray starts, along it
    std::optional<RayHit> first;
};

}  // namespace

struct RayOracle::Impl {
    std::shared_ptr<const Scene> scene;
    glm::dvec3 origin{0.0};
    double pad = 0;
    std::vector<Triangle> triangles;
    std::vector<std::size_t> first_triangle;  ///< per instance
    RTCDevice device = nullptr;
    RTCScene embree = nullptr;

    bool meets(Query& query, const Triangle& triangle, double& distance) const {
        const Instance& instance = scene->instances[triangle.ids.instance];
        if (!(instance.flags & query.flags)) return false;
        if (query.light && !(query.light->blocker_set >> instance.blocker_group & 1u)) return false;
        if (query.has_self && triangle.ids.instance == query.self.instance &&
            triangle.ids.triangle == query.self.triangle)
            return false;
        const auto hit = intersect_triangle(query.origin, query.direction, triangle.corners);
        if (!hit || !(*hit > query.near && *hit < query.far)) return false;
        if (query.has_self && is_neighbour_in_plane(query.self_corners, triangle.corners)) return false;
        if (query.leaves_plane_out && lies_in_plane(triangle.corners, query.origin, query.self_normal)) return false;
        distance = *hit;
        return true;
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
        double distance;
        if (self.meets(query, self.triangles[args->primID], distance))
            reinterpret_cast<RTCRay*>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
    }
    static void intersected(const RTCIntersectFunctionNArguments* args) {
        if (!args->valid[0]) return;
        const auto& self = *static_cast<const Impl*>(args->geometryUserPtr);
        auto& query = *reinterpret_cast<Query*>(args->context);
        double distance;
        if (!self.meets(query, self.triangles[args->primID], distance)) return;
        query.far = distance;
        query.first = RayHit{self.triangles[args->primID].ids, distance};
        reinterpret_cast<RTCRayHit*>(args->rayhit)->ray.tfar = float(distance * query.length - query.ahead + self.pad);
    }

    RTCRay make_ray(Query& query) const {
        const double length = query.length = glm::length(query.direction);
        const glm::dvec3 unit = query.direction / length;
        // A start far outside of the scene is moved along the ray to just before it, for the sake of float boxes.
        const double ahead = query.ahead = std::max(query.near * length, -glm::dot(query.origin, unit) - reach * 2);
        const glm::dvec3 start = query.origin + ahead * unit;
        RTCRay ray{};
        ray.org_x = float(start.x), ray.org_y = float(start.y), ray.org_z = float(start.z);
        ray.dir_x = float(unit.x), ray.dir_y = float(unit.y), ray.dir_z = float(unit.z);
        ray.tnear = 0;
        ray.tfar = float(std::min(query.far * length - ahead + pad, 1e30));
        ray.mask = ~0u;
        return ray;
    }
    double reach = 0;
};

RayOracle::RayOracle(std::shared_ptr<const Scene> scene) : impl_(std::make_unique<Impl>()) {
    impl_->scene = std::move(scene);
    const Scene& all = *impl_->scene;
    const Bounds bounds = compute_scene_bounds(all, ~0u);
    if (!bounds.is_empty()) {
        impl_->origin = 0.5 * (bounds.min + bounds.max);
        impl_->reach = glm::length(bounds.max - bounds.min);
    }
    impl_->pad = 2e-6 * impl_->reach;
    for (std::uint32_t i = 0; i < all.instances.size(); ++i) {
        const Instance& instance = all.instances[i];
        const Mesh& mesh = *all.meshes[instance.mesh];
        glm::dmat4 matrix = instance.world_from_object;
        matrix[3] -= glm::dvec4(impl_->origin, 0);
        impl_->first_triangle.push_back(impl_->triangles.size());
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            Triangle triangle;
            bool usable = true;
            for (int k = 0; k < 3; ++k) {
                const glm::vec3& p = mesh.positions[mesh.triangles[t][k]];
                usable = usable && is_usable_vertex(p);
                triangle.corners[k] = glm::dvec3(matrix * glm::dvec4(p, 1));
            }
            if (!usable) triangle.corners = {};  // no area at the origin: met by no ray
            triangle.ids = {i, t};
            impl_->triangles.push_back(triangle);
        }
    }
    impl_->device = rtcNewDevice(nullptr);
    if (!impl_->device) throw std::runtime_error("Embree made no device");
    impl_->embree = rtcNewScene(impl_->device);
    rtcSetSceneFlags(impl_->embree, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, unsigned(impl_->triangles.size()));
    rtcSetGeometryUserData(geometry, impl_.get());
    rtcSetGeometryBoundsFunction(
        geometry, [](const RTCBoundsFunctionArguments* args) { Impl::bounds(args); }, nullptr);
    rtcSetGeometryOccludedFunction(geometry, &Impl::occluded);
    rtcSetGeometryIntersectFunction(geometry, &Impl::intersected);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->embree, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(impl_->embree);
}

RayOracle::~RayOracle() {
    rtcReleaseScene(impl_->embree);
    rtcReleaseDevice(impl_->device);
}

glm::dvec3 RayOracle::get_origin() const { return impl_->origin; }

std::array<glm::dvec3, 3> RayOracle::get_corners(const PixelIds& ids) const {
    return impl_->triangles[impl_->first_triangle[ids.instance] + ids.triangle].corners;
}

std::optional<RayHit> RayOracle::find_first(const glm::dvec3& origin_ws, const glm::dvec3& direction, double near,
                                            double far, std::uint32_t flags) const {
    Query query;
    rtcInitIntersectContext(&query.context);
    query.origin = origin_ws - impl_->origin;
    query.direction = direction;
    query.near = near, query.far = far, query.flags = flags;
    RTCRayHit ray{};
    ray.ray = impl_->make_ray(query);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(impl_->embree, &query.context, &ray);
    return query.first;
}

bool RayOracle::is_occluded(const glm::dvec3& receiver_ws, const PixelIds& receiver, const Light& light,
                            const LightSample& position, OwnSurface own) const {
    Query query;
    rtcInitIntersectContext(&query.context);
    query.origin = receiver_ws - impl_->origin;
    query.direction =
        position.directional ? position.to_light_ws * (4 * impl_->reach + 1e-300) : position.position_ws - receiver_ws;
    if (query.direction == glm::dvec3(0)) return false;
    query.near = 0;
    query.far = 1;
    query.flags = kInstanceShadow;
    query.light = &light;
    query.self = receiver;
    query.self_corners = get_corners(receiver);
    query.has_self = true;
    query.leaves_plane_out = own == OwnSurface::WholePlane;
    const Corners& c = query.self_corners;
    query.self_normal = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
    RTCRay ray = impl_->make_ray(query);
    rtcOccluded1(impl_->embree, &query.context, &ray);
    return ray.tfar < 0;
}

std::optional<double> RayOracle::meet_plane(const PixelRay& ray, const PixelIds& ids) const {
    const std::array<glm::dvec3, 3> corners = get_corners(ids);
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double along = glm::dot(ray.direction, normal);
    if (along == 0) return std::nullopt;
    return glm::dot(corners[0] + (impl_->origin - ray.origin_ws), normal) / along;
}

std::vector<float> RayOracle::compute_visibility(const Frame& frame, const Light& light, const LightSample& position,
                                                 ThreadPool* threads) const {
    const FacingRule rule(frame, light, position);
    std::vector<float> visibility(frame.pixel_count());
    const auto work = [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            const Facing facing = rule.classify(pixel);
            visibility[pixel] = get_unoccluded_visibility(facing);
            if (facing != Facing::Lit || !light.casts_shadow) continue;
            const PixelIds ids = frame.ids[pixel];
            const PixelRay ray =
                compute_pixel_ray(frame.camera, double(pixel % std::size_t(frame.width)) + 0.5,
                                  double(pixel / std::size_t(frame.width)) + 0.5, frame.width, frame.height);
            const auto distance = meet_plane(ray, ids);
            const glm::dvec3 receiver = distance ? ray.origin_ws + *distance * ray.direction
                                                 : frame.origin_ws + glm::dvec3(frame.positions_rel[pixel]);
            if (is_occluded(receiver, ids, light, position)) visibility[pixel] = 0;
        }
    };
    if (threads)
        threads->parallel_for(frame.pixel_count(), 1 << 12, work);
    else
        work(0, frame.pixel_count());
    return visibility;
}

void RayOracle::set_receiver(Frame& frame, std::size_t pixel, const PixelRay& ray, const RayHit& hit) const {
    const Corners c = get_corners(hit.ids);
    const glm::dvec3 normal = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
    frame.ids[pixel] = hit.ids;
    frame.coverage[pixel] = !(impl_->scene->instances[hit.ids.instance].flags & kInstanceHoldout);
    frame.positions_rel[pixel] = glm::vec3(ray.origin_ws + hit.distance * ray.direction - frame.origin_ws);
    frame.normals[pixel] = glm::vec3(glm::dot(normal, ray.direction) > 0 ? -normal : normal);
}

Frame RayOracle::make_frame(const Camera& camera, int width, int height, ThreadPool* threads) const {
    Frame frame;
    frame.width = width, frame.height = height;
    frame.region = {0, 0, width, height};
    frame.camera = camera;
    frame.origin_ws = glm::dvec3(camera.world_from_camera[3]);
    frame.scene = impl_->scene;
    frame.positions_rel.assign(frame.pixel_count(), glm::vec3(0));
    frame.normals.assign(frame.pixel_count(), glm::vec3(0));
    frame.ids.assign(frame.pixel_count(), {});
    frame.coverage.assign(frame.pixel_count(), 0);
    const auto work = [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            const PixelRay ray = compute_pixel_ray(camera, double(pixel % std::size_t(width)) + 0.5,
                                                   double(pixel / std::size_t(width)) + 0.5, width, height);
            const auto hit =
                find_first(ray.origin_ws, ray.direction, camera.clip_start, camera.clip_end, kInstanceCamera);
            if (hit) set_receiver(frame, pixel, ray, *hit);
        }
    };
    if (threads)
        threads->parallel_for(frame.pixel_count(), 1 << 12, work);
    else
        work(0, frame.pixel_count());
    return frame;
}

PixelRay compute_pixel_ray(const Camera& camera, double x_px, double y_px, int width, int height) {
    const CameraWindow& window = camera.window;
    const double x = window.left + (window.right - window.left) * x_px / width;
    const double y = window.bottom + (window.top - window.bottom) * y_px / height;
    const glm::dmat3 axes(camera.world_from_camera);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    if (camera.perspective) return {eye, axes * glm::dvec3(x, y, -1)};
    return {eye + axes * glm::dvec3(x, y, 0), axes * glm::dvec3(0, 0, -1)};
}

}  // namespace shadow_layers::truth
