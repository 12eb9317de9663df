// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/light_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/hash.h"
#include "base/thread_pool.h"
#include "lights/light_shape.h"
#include "lights/map_fit.h"
#include "lights/receiver_scan.h"
#include "lights/view_casters.h"
#include "scene/bounds.h"

namespace shadow_layers {

namespace {

/// Widest spot that one map serves; a wider one gets cube faces.
constexpr double kWidestCone = 120 * std::numbers::pi / 180;
/// A spot this many times farther than the scene is deep keeps its texels at rest to the scene, as a sun does.
constexpr double kFarSpotDepths = 1;
/// The near plane's least part of the far plane; reversed float depth keeps its precision all the same.
constexpr double kLeastNear = 1e-6;
/// Beyond the farthest receiver, as a part of the depth range and of the map's width.
constexpr double kFarMargin = 1e-3;
/// Turns of a map about its axis, of which one is taken if it saves at least this part of the area.
constexpr int kTurnCount = 8;
constexpr double kTurnGain = 0.15;
/// Every so many pixels suffice to choose the turn.
constexpr std::size_t kTurnStride = 17;

/// A view before it is fitted.
struct ViewSeed {
    bool perspective = true;
    std::uint8_t face = 0;
    ViewAxes axes{1.0};
    glm::dvec3 origin_ws{0.0};
    Interval u, v;     ///< the frame of fit_map_interval
    Bounds receivers;  ///< (u, v, depth)
};

glm::dmat4 compute_ls_from_ws(const ViewSeed& seed) {
    const glm::dmat3 turn = glm::transpose(seed.axes);
    glm::dmat4 matrix(turn);
    matrix[3] = glm::dvec4(-(turn * seed.origin_ws), 1);
    return matrix;
}

/// Maps u, v in the intervals to x, y in [-w, w] and depth near..far to z / w = 1..0.
glm::dmat4 compute_lc_from_ls(bool perspective, const Interval& u, const Interval& v, double near, double far) {
    glm::dmat4 m(0.0);
    m[0][0] = 2 / u.size();
    m[1][1] = 2 / v.size();
    if (perspective) {
        // x_lc = (2 x - (u.low + u.high) depth) / u.size with depth = -z; z_lc = near (far - depth) / (far - near)
        m[2][0] = 2 * u.middle() / u.size();
        m[2][1] = 2 * v.middle() / v.size();
        m[2][2] = near / (far - near);
        m[3][2] = near * far / (far - near);
        m[2][3] = -1;
    } else {
        m[3][0] = -2 * u.middle() / u.size();
        m[3][1] = -2 * v.middle() / v.size();
        m[2][2] = 1 / (far - near);  // z_lc = (far - depth) / (far - near)
        m[3][2] = far / (far - near);
        m[3][3] = 1;
    }
    return m;
}

Interval grow(const Interval& inner, int map_size, int border_texels) {
    const double margin = inner.size() * border_texels / map_size;
    return {inner.low - margin, inner.high + margin};
}

/// The u and v that the map covers without its border; the inverse of what make_view put into lc_from_ls.
std::pair<Interval, Interval> find_inner_region(const LightView& view) {
    const glm::dmat4& m = view.lc_from_ls;
    const double share = double(view.size_texels - 2 * view.border_texels) / view.size_texels;
    const auto interval = [&](int i) {
        const double half = 1 / m[i][i], middle = (view.perspective ? m[2][i] : -m[3][i]) * half;
        return Interval{middle - share * half, middle + share * half};
    };
    return {interval(0), interval(1)};
}

ContentKey compute_view_key(const Scene& scene, const LightView& view) {
    KeyBuilder builder("light_view");
    builder.add(view.perspective).add(view.size_texels).add(view.border_texels).add(view.lc_from_ws);
    for (const std::uint32_t index : view.casters) {
        const Instance& instance = scene.instances[index];
        const Mesh& mesh = *scene.meshes[instance.mesh];
        builder.add(index).add(mesh.positions_key).add(mesh.topology_key).add(instance.world_from_object);
    }
    return builder.key();
}

/// The planes round receivers and casters. The range is never much smaller than the map is wide, so that a lone flat
/// receiver, which has no depth of its own, does not turn rounding into depth.
void set_depth_range(const Bounds& receivers, double nearest_caster, double margin, LightView& view) {
    const double farthest = receivers.max.z;
    double near = std::min(nearest_caster, receivers.min.z);
    if (view.perspective) near = std::max(near, farthest * kLeastNear);
    view.near_ls = near;
    view.far_ls = farthest + std::max(kFarMargin * (farthest - near), margin);
}

class ViewMaker {
public:
    ViewMaker(const ReceiverSource& receivers, const Light& light, const ViewSettings& settings, ThreadPool* threads)
        : receivers_(receivers), scene_(*receivers.scene), light_(light), settings_(settings), threads_(threads) {}

    void add_views(LightSample& sample, const LightSample* previous) const {
        if (light_.kind == LightKind::Sun || has_one_cone()) {
            const LightView* kept = previous && !previous->views.empty() ? &previous->views.front() : nullptr;
            const ViewSeed seed = make_single_seed(sample, kept);
            if (!seed.receivers.is_empty()) sample.views.push_back(make_view(seed, kept));
            sample.choice = make_view_choice(kOneView, sample.views);
            return;
        }
        const ReceiverScan scan(receivers_, light_, sample, sample.position_ws, threads_);
        const auto receivers = scan.measure_faces(sample.axes_ws);
        for (int face = 0; face < 6; ++face) {
            if (receivers[face].is_empty()) continue;
            const LightView* kept = nullptr;
            if (previous)
                for (const LightView& view : previous->views)
                    if (view.face == face) kept = &view;
            const ViewAxes axes = compute_face_axes(sample.axes_ws, face);
            sample.views.push_back(make_view(
                {true, std::uint8_t(face), axes, sample.position_ws, {-1, 1}, {-1, 1}, receivers[face]}, kept));
        }
        sample.choice = make_view_choice(kCubeFaces, sample.views);
    }

private:
    bool has_one_cone() const {
        return light_.kind == LightKind::Spot && find_widest_spot_angle(light_) <= kWidestCone;
    }

    /// The frame of a sun's map: the scene's bounds across its axes.
    void set_sun_frame(ViewSeed& seed) const {
        const glm::dmat4 ls_from_ws = compute_ls_from_ws(seed);
        Bounds all;
        for (const Instance& instance : scene_.instances)
            if (instance.flags & (kInstanceCamera | kInstanceShadow))
                all.add(
                    transform_bounds(scene_.meshes[instance.mesh]->bounds, ls_from_ws * instance.world_from_object));
        seed.u = {all.min.x, all.max.x};
        seed.v = {all.min.y, all.max.y};
        give_width(seed, all.max.z - all.min.z);
    }

    /// A scene that is flat as seen from the light still gets a map with an area.
    static void give_width(ViewSeed& seed, double depth) {
        double least = 1e-3 * std::max({seed.u.size(), seed.v.size(), depth});
        if (!(least > 0)) least = 1e-3;
        for (Interval* interval : {&seed.u, &seed.v})
            if (interval->size() < least)
                *interval = {interval->middle() - 0.5 * least, interval->middle() + 0.5 * least};
    }

    /// The frame of a spot's map: the rectangle round its cone; what the scene takes up of it if the light is far away,
    /// so that a spot that goes to infinity ends with the texels of a sun.
    void set_spot_frame(ViewSeed& seed) const {
        const double half_side = std::tan(0.5 * light_.spot_angle);
        const double half_u = half_side * find_cone_width(seed.axes[0]),
                     half_v = half_side * find_cone_width(seed.axes[1]);
        seed.u = {-half_u, half_u};
        seed.v = {-half_v, half_v};
        const glm::dmat4 ls_from_ws = compute_ls_from_ws(seed);
        Bounds depths, seen;
        for (const Instance& instance : scene_.instances) {
            const Bounds& bounds = scene_.meshes[instance.mesh]->bounds;
            if (!(instance.flags & (kInstanceCamera | kInstanceShadow)) || bounds.is_empty()) continue;
            const glm::dmat4 ls_from_object = ls_from_ws * instance.world_from_object;
            for (int k = 0; k < 8; ++k) {
                const glm::dvec4 corner = ls_from_object * glm::dvec4(box_corner(bounds, k), 1);
                depths.add({0, 0, -corner.z});
                if (!(corner.z < 0)) return;
                seen.add({corner.x / -corner.z, corner.y / -corner.z, 0});
            }
        }
        if (!(depths.min.z > kFarSpotDepths * (depths.max.z - depths.min.z))) return;
        const Interval u{std::max(seed.u.low, seen.min.x), std::min(seed.u.high, seen.max.x)};
        const Interval v{std::max(seed.v.low, seen.min.y), std::min(seed.v.high, seen.max.y)};
        if (!(u.size() >= 0 && v.size() >= 0)) return;  // the scene lies outside the cone
        seed.u = u;
        seed.v = v;
        give_width(seed, 0);
    }

    /// Of a spot's cone along an axis across its direction, of the round one's width: half the side of an ellipse's
    /// box.
    double find_cone_width(const glm::dvec3& across) const {
        const glm::dvec2& scale = light_.spot_scale;
        if (scale.x == scale.y) return scale.x;
        const glm::dmat3 axes = compute_light_axes(light_.world_from_light);
        return glm::length(scale * glm::dvec2(glm::dot(across, axes[0]), glm::dot(across, axes[1])));
    }

    /// Sun or narrow spot: one view, turned about its axis where that is worth it. An earlier view's turn is kept.
    ViewSeed make_single_seed(const LightSample& sample, const LightView* kept) const {
        ViewSeed seed;
        seed.perspective = !sample.directional;
        seed.axes = sample.axes_ws;
        const Bounds bounds = compute_scene_bounds(scene_);
        if (bounds.is_empty()) return seed;
        seed.origin_ws = sample.directional ? 0.5 * (bounds.min + bounds.max) : sample.position_ws;
        const ReceiverScan scan(receivers_, light_, sample, seed.origin_ws, threads_);
        if (kept)
            seed.axes = glm::transpose(glm::dmat3(kept->ls_from_ws));
        else
            turn_seed(scan, seed);
        seed.receivers = scan.measure(seed.axes);
        if (seed.perspective)
            set_spot_frame(seed);
        else
            set_sun_frame(seed);
        return seed;
    }

    static void turn_seed(const ReceiverScan& scan, ViewSeed& seed) {
        std::vector<double> turns;
        for (int i = 0; i < kTurnCount; ++i) turns.push_back(i * 0.5 * std::numbers::pi / kTurnCount);
        const std::vector<Bounds> boxes = scan.measure_turns(seed.axes, turns, kTurnStride);
        const auto area = [&](int i) { return (boxes[i].max.x - boxes[i].min.x) * (boxes[i].max.y - boxes[i].min.y); };
        if (boxes[0].is_empty()) return;
        int best = 0;
        // The next best must be better by 1 %: of two turns that a symmetric scene makes equal, noise must not choose.
        for (int i = 1; i < kTurnCount; ++i)
            if (area(i) < (best == 0 ? 1 - kTurnGain : 0.99) * area(best)) best = i;
        const double c = std::cos(turns[best]), s = std::sin(turns[best]);
        const ViewAxes axes = seed.axes;
        seed.axes[0] = c * axes[0] + s * axes[1];
        seed.axes[1] = c * axes[1] - s * axes[0];
    }

    bool still_covers(const LightView& view, const Bounds& receivers) const {
        const auto [u, v] = find_inner_region(view);
        return receivers.min.x >= u.low && receivers.max.x <= u.high && receivers.min.y >= v.low &&
               receivers.max.y <= v.high && receivers.max.z <= view.far_ls;  // nearer than near_ls is lit all the same
    }

    LightView make_view(const ViewSeed& seed, const LightView* kept) const {
        Bounds receivers = seed.receivers;
        if (kept && kept->size_texels == settings_.map_size + 2 * settings_.border_texels &&
            kept->border_texels == settings_.border_texels) {
            if (still_covers(*kept, receivers)) return *kept;
            // Grown rather than moved, so that after a few samples one view covers all that follow.
            const auto [u, v] = find_inner_region(*kept);
            const double texel_u = u.size() / settings_.map_size, texel_v = v.size() / settings_.map_size;
            receivers.add({u.low + texel_u, v.low + texel_v, kept->far_ls});
            receivers.add({u.high - texel_u, v.high - texel_v, kept->far_ls});
        }
        LightView view;
        view.perspective = seed.perspective;
        view.face = seed.face;
        view.border_texels = settings_.border_texels;
        view.size_texels = settings_.map_size + 2 * settings_.border_texels;
        view.ls_from_ws = compute_ls_from_ws(seed);
        const Interval u = fit_map_interval({receivers.min.x, receivers.max.x}, seed.u, settings_.map_size);
        const Interval v = fit_map_interval({receivers.min.y, receivers.max.y}, seed.v, settings_.map_size);
        const Interval outer_u = grow(u, settings_.map_size, settings_.border_texels);
        const Interval outer_v = grow(v, settings_.map_size, settings_.border_texels);
        const double margin = kFarMargin * outer_u.size() * (seed.perspective ? receivers.max.z : 1);
        ViewCasters casters = find_view_casters(
            scene_, light_, {seed.perspective, view.ls_from_ws, outer_u, outer_v, receivers.max.z + margin}, threads_);
        set_depth_range(receivers, casters.nearest, margin, view);
        view.casters = std::move(casters.instances);
        view.lc_from_ls = compute_lc_from_ls(view.perspective, outer_u, outer_v, view.near_ls, view.far_ls);
        view.lc_from_ws = view.lc_from_ls * view.ls_from_ws;
        view.key = compute_view_key(scene_, view);
        return view;
    }

    const ReceiverSource& receivers_;
    const Scene& scene_;
    const Light& light_;
    const ViewSettings& settings_;
    ThreadPool* threads_;
};

}  // namespace

ViewChoice make_view_choice(int kind, const std::vector<LightView>& views) {
    ViewChoice choice = LightSample().choice;
    choice.kind = glm::ivec4(kind, int(views.size()), 0, 0);
    for (std::size_t view = 0; view < views.size(); ++view)
        choice.view_of_face[views[view].face / 4][views[view].face % 4] = int(view);
    return choice;
}

LightSample fit_light_views(const ReceiverSource& receivers, const Light& light, LightSample point,
                            const ViewSettings& settings, const LightSample* previous, ThreadPool* threads) {
    point.views.clear();
    point.choice = LightSample().choice;
    if (settings.map_size <= 0) return point;
    point.scene = receivers.scene;
    const bool known = previous && previous->scene == receivers.scene && point.is_same_place(*previous);
    ViewMaker(receivers, light, settings, threads).add_views(point, known ? previous : nullptr);
    return point;
}

std::vector<LightSample> make_light_samples(const ReceiverSource& receivers, const Light& light,
                                            const ViewSettings& settings, const std::vector<LightSample>* previous,
                                            ThreadPool* threads) {
    std::vector<LightSample> samples = sample_light_shape(light, settings.sample_count, settings.pattern);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const LightSample* kept = previous && i < previous->size() ? &(*previous)[i] : nullptr;
        samples[i] = fit_light_views(receivers, light, std::move(samples[i]), settings, kept, threads);
    }
    return samples;
}

}  // namespace shadow_layers
