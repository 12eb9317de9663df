// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/exact_layers.h"

#include <array>
#include <cmath>

#include "base/thread_pool.h"
#include "lights/light_shape.h"
#include "lights/light_views.h"
#include "shadow_layers/error.h"
#include "truth/pixel_means.h"
#include "truth/ray_oracle.h"
#include "truth/soft_shadow.h"

namespace shadow_layers::truth {
namespace {

constexpr std::size_t kBlock = 1 << 12;
constexpr double kSelfPart = 1e-6;  // of the distance to the light: parts a surface from the next
constexpr int kMostOwnHits = 64;

// The plane of the triangle that a pixel sees.
struct ReceiverPlane {
    glm::dvec3 point_ws{0.0}, normal{0.0};  // normal: not unit
};

// A square of points in a receiver's plane, addressed by (x, y) in [-1, 1]².
class Footprint {
public:
    explicit Footprint(const ReceiverPlane& plane) : plane_(plane) {}
    virtual ~Footprint() = default;
    const glm::dvec3& centre() const { return plane_.point_ws; }
    virtual std::optional<glm::dvec3> point_at(double x, double y) const = 0;

protected:
    ReceiverPlane plane_;
};

// The square lies in the plane itself, `side` scene units wide.
class PlaneFootprint final : public Footprint {
public:
    PlaneFootprint(const ReceiverPlane& plane, double side) : Footprint(plane) {
        const glm::dvec3 normal = glm::normalize(plane.normal);
        const glm::dvec3 aside = std::abs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        x_ = glm::normalize(glm::cross(normal, aside)) * (0.5 * side);
        y_ = glm::cross(normal, x_);
    }
    std::optional<glm::dvec3> point_at(double x, double y) const override { return plane_.point_ws + x * x_ + y * y_; }

private:
    glm::dvec3 x_{0.0}, y_{0.0};
};

// A view with its inverse: lines through its map's plane.
struct MapPlane {
    const LightView* view = nullptr;
    glm::dmat4 ls_from_lc{1.0}, ws_from_ls{1.0};
};

// The square lies in the map: lines of light through it meet the plane. None where they miss it.
class MapFootprint final : public Footprint {
public:
    MapFootprint(const ReceiverPlane& plane, const MapPlane& map, double side_texels) : Footprint(plane), map_(map) {
        const glm::dvec4 place_lc = map.view->lc_from_ws * glm::dvec4(plane.point_ws, 1);
        centre_ = glm::dvec2(place_lc) / place_lc.w;
        half_ = side_texels / map.view->size_texels;  // clip space is 2 wide, half a side is wanted
    }
    std::optional<glm::dvec3> point_at(double x, double y) const override {
        const glm::dvec2 place = centre_ + half_ * glm::dvec2(x, y);
        const glm::dvec3 near = unproject(place, 1), far = unproject(place, 0);
        const glm::dvec3 along = far - near;
        const double slope = glm::dot(along, plane_.normal);
        if (slope == 0) return std::nullopt;
        const double distance = glm::dot(plane_.point_ws - near, plane_.normal) / slope;
        const glm::dvec3 point = near + distance * along;
        const glm::dvec4 back = map_.view->lc_from_ws * glm::dvec4(point, 1);
        if (!std::isfinite(distance) || !(back.w > 0)) return std::nullopt;  // beyond the plane's horizon
        return point;
    }

private:
    glm::dvec3 unproject(const glm::dvec2& place, double depth) const {
        const glm::dvec4 ls = map_.ls_from_lc * glm::dvec4(place, depth, 1);
        return glm::dvec3(map_.ws_from_ls * glm::dvec4(glm::dvec3(ls) / ls.w, 1));
    }

    const MapPlane& map_;
    glm::dvec2 centre_{0.0};
    double half_ = 0;
};

}  // namespace

struct ExactLayers::Impl {
    Impl(std::shared_ptr<const Scene> scene, int threads, const std::atomic<bool>& cancelled_flag)
        : oracle(std::move(scene)), pool(threads), cancelled(cancelled_flag) {}

    /// Calls work(pixel) for all pixels, by many threads.
    template <class Work>
    void for_pixels(const Work& work) {
        pool.parallel_for(frame.pixel_count(), kBlock, [&](std::size_t begin, std::size_t end) {
            check_cancelled();
            for (std::size_t pixel = begin; pixel < end; ++pixel) work(pixel);
        });
    }

    Standing find_standing(const LightRule& rule, std::size_t pixel) const {
        const auto receiver = oracle.find_receiver(frame, pixel);
        return receiver ? rule.find_standing(*receiver) : Standing::Apart;
    }

    template <class Decide>
    std::vector<float> decide_pixels(const Light& light, const LightSample& position, const Decide& decide) {
        const LightRule rule(*frame.scene, light, position);
        std::vector<float> visibility(frame.pixel_count());
        for_pixels([&](std::size_t pixel) {
            const Standing standing = find_standing(rule, pixel);
            visibility[pixel] = standing == Standing::Facing && light.casts_shadow ? decide(pixel)
                                : standing == Standing::TurnedAway                 ? 0.0f
                                                                                   : 1.0f;
        });
        return visibility;
    }

    ReceiverPlane find_plane(std::size_t pixel) const {
        const std::array<glm::dvec3, 3> corners = oracle.get_corners(frame.ids[pixel]);
        const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const PixelRay ray =
            compute_pixel_ray(frame.camera, double(pixel % std::size_t(frame.width)) + 0.5,
                              double(pixel / std::size_t(frame.width)) + 0.5, frame.width, frame.height);
        const auto distance = oracle.meet_plane(ray, frame.ids[pixel]);
        return {distance ? ray.origin_ws + *distance * ray.direction
                         : frame.origin_ws + glm::dvec3(frame.positions_rel[pixel]),
                normal};
    }

    // Is a point of the receiver's plane, away from the receiver, in shadow? The receiver's own surface may rise before
    // its plane there, where it is hollow: nearer to the plane than the point is to the receiver, it is no blocker.
    bool is_shadowed(const glm::dvec3& point, const glm::dvec3& receiver, const PixelIds& ids, const Light& light,
                     const LightSample& position) const {
        if (!oracle.is_occluded(point, ids, light, position)) return false;
        const glm::dvec3 to_light = position.directional ? position.to_light_ws : position.position_ws - point;
        const double rise = glm::length(point - receiver);
        if (!position.directional && rise >= glm::length(to_light)) return true;
        const glm::dvec3 unit = glm::normalize(to_light);
        if (rise == 0 || oracle.is_occluded(point + rise * unit, ids, light, position)) return true;
        double near = kSelfPart * rise;
        for (int k = 0; k < kMostOwnHits; ++k) {
            const auto hit = oracle.find_first(point, unit, near, rise, kInstanceShadow);
            if (!hit) return false;
            if (hit->ids.instance != ids.instance) return true;
            near = hit->distance + kSelfPart * rise;
        }
        return true;
    }

    float filter(const Footprint& footprint, std::size_t pixel, const Light& light, const LightSample& position) const {
        int lit = 0, counted = 0;
        const auto take = [&](double x, double y) {
            const auto point = footprint.point_at(x, y);
            if (!point) return;
            ++counted;
            lit += !is_shadowed(*point, footprint.centre(), frame.ids[pixel], light, position);
        };
        for (const double y : {-1.0, 0.0, 1.0}) {
            for (const double x : {-1.0, 0.0, 1.0}) take(x, y);
        }
        if (lit != 0 && lit != counted) {
            lit = counted = 0;
            for (int y = 0; y < kFilterSide; ++y) {
                for (int x = 0; x < kFilterSide; ++x)
                    take((2 * x + 1.0) / kFilterSide - 1, (2 * y + 1.0) / kFilterSide - 1);
            }
        }
        return counted > 0 ? float(lit) / float(counted) : 1.0f;
    }

    // The view that a receiver falls into; null where the fit to another frame's receivers left it out.
    static const MapPlane* find_view(const std::vector<MapPlane>& views, const glm::dvec3& point_ws) {
        for (const MapPlane& map : views) {
            const glm::dvec4 lc = map.view->lc_from_ws * glm::dvec4(point_ws, 1);
            if (lc.w > 0 && std::abs(lc.x) <= lc.w && std::abs(lc.y) <= lc.w) return &map;
        }
        return nullptr;
    }

    std::vector<float> compute_filtered(const Light& light, const TruthSpec& spec, int map_size) {
        const auto positions = make_light_samples(frame, light, {map_size, 0, 1}, nullptr, &pool);
        const LightSample& position = positions.front();
        std::vector<MapPlane> views;
        for (const LightView& view : position.views)
            views.push_back({&view, glm::inverse(view.lc_from_ls), glm::inverse(view.ls_from_ws)});
        return decide_pixels(light, position, [&](std::size_t pixel) {
            const ReceiverPlane plane = find_plane(pixel);
            if (spec.footprint_world > 0)
                return filter(PlaneFootprint(plane, spec.footprint_world), pixel, light, position);
            const MapPlane* map = find_view(views, plane.point_ws);
            const double side = map ? spec.footprint_texels : 0;
            if (!(side > 0)) return oracle.is_occluded(plane.point_ws, frame.ids[pixel], light, position) ? 0.0f : 1.0f;
            return filter(MapFootprint(plane, *map, side), pixel, light, position);
        });
    }

    std::vector<float> compute_hard(const Light& light, const LightSample& position) {
        return decide_pixels(light, position, [&](std::size_t pixel) {
            const glm::dvec3 point_ws = find_plane(pixel).point_ws;
            return oracle.is_occluded(point_ws, frame.ids[pixel], light, position) ? 0.0f : 1.0f;
        });
    }

    SoftTruth compute_soft(const Light& light) {
        const ShapeShadows shadows(oracle, frame, light);
        SoftTruth truth{std::vector<float>(frame.pixel_count()), std::vector<float>(frame.pixel_count())};
        for_pixels([&](std::size_t pixel) {
            const LitEstimate estimate = shadows.estimate_lit_part(pixel);
            truth.mean[pixel] = float(estimate.mean), truth.standard_error[pixel] = float(estimate.standard_error);
        });
        return truth;
    }

    std::vector<float> compute_pixel(const Light& light) {
        if (!tree) tree.emplace(oracle, *frame.scene);
        return compute_pixel_means(oracle, *tree, frame, light, sample_light_shape(light, 1).front(), pool,
                                   [&] { check_cancelled(); });
    }

    void check_cancelled() const {
        if (cancelled) throw Cancelled();
    }

    RayOracle oracle;
    mutable ThreadPool pool;
    const std::atomic<bool>& cancelled;
    Frame frame;
    std::optional<TriangleTree> tree;  // made when first asked for
};

ExactLayers::ExactLayers(std::shared_ptr<const Scene> scene, const Camera& camera, int width, int height, int threads,
                         const std::atomic<bool>& cancelled)
    : impl_(std::make_unique<Impl>(std::move(scene), threads, cancelled)) {
    impl_->check_cancelled();
    impl_->frame = impl_->oracle.make_frame(camera, width, height, &impl_->pool);
    impl_->check_cancelled();
}

ExactLayers::~ExactLayers() = default;

std::vector<float> ExactLayers::compute(std::uint32_t light, const TruthSpec& spec, int map_size) const {
    const Light& source = impl_->frame.scene->lights[light];
    switch (spec.kind) {
        case TruthKind::Soft:
            return impl_->compute_soft(source).mean;
        case TruthKind::Filtered:
            return impl_->compute_filtered(source, spec, map_size);
        case TruthKind::Pixel:
            return impl_->compute_pixel(source);
        case TruthKind::Hard:
            break;
    }
    return impl_->compute_hard(source, sample_light_shape(source, 1).front());
}

SoftTruth ExactLayers::compute_soft(std::uint32_t light) const {
    return impl_->compute_soft(impl_->frame.scene->lights[light]);
}

std::vector<LitPart> ExactLayers::compute_at_samples(std::uint32_t light, int light_samples, LightPattern pattern,
                                                     const IdImage& ids) const {
    Frame seen = impl_->frame;
    for (std::size_t pixel = 0; pixel < seen.pixel_count(); ++pixel) {
        const std::int64_t* id = &ids.data[2 * pixel];
        seen.ids[pixel] = id[0] < 0 ? PixelIds{} : PixelIds{std::uint32_t(id[0]), std::uint32_t(id[1])};
        seen.coverage[pixel] =
            id[0] >= 0 && !(seen.scene->instances[seen.ids[pixel].instance].flags & kInstanceHoldout);
    }
    const Light& source = seen.scene->lights[light];
    const auto samples = sample_light_shape(source, light_samples, pattern);
    const SampleShadows shadows(impl_->oracle, seen, source, samples);
    std::vector<LitPart> parts(seen.pixel_count());
    impl_->for_pixels([&](std::size_t pixel) { parts[pixel] = shadows.find_lit_part(pixel); });
    return parts;
}

std::vector<std::uint8_t> ExactLayers::find_comparable(std::uint32_t light) const {
    const Light& source = impl_->frame.scene->lights[light];
    const LightSample position = sample_light_shape(source, 1).front();
    const LightRule rule(*impl_->frame.scene, source, position);
    std::vector<std::uint8_t> comparable(impl_->frame.pixel_count());
    impl_->for_pixels(
        [&](std::size_t pixel) { comparable[pixel] = impl_->find_standing(rule, pixel) == Standing::Facing; });
    return comparable;
}

}  // namespace shadow_layers::truth
