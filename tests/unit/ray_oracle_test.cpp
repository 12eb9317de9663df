// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The truth of other tests is itself checked against plain loops over all triangles.
#include "support/ray_oracle.h"

#include <gtest/gtest.h>

#include <random>

#include "lights/light_shape.h"
#include "scene/bounds.h"
#include "support/soup_scene.h"

namespace shadow_layers::testing {
namespace {

/// Distance to a triangle in long double by solving for barycentric coordinates; negative if it is missed.
long double solve(const glm::dvec3& o, const glm::dvec3& d, const std::array<glm::dvec3, 3>& c) {
    using V = glm::tvec3<long double>;
    const V a(c[0]), e(V(c[1]) - a), f(V(c[2]) - a), way(d), p = glm::cross(way, f);
    const long double det = glm::dot(e, p);
    if (det == 0) return -1;
    const V s = V(o) - a, q = glm::cross(s, e);
    const long double u = glm::dot(s, p) / det, v = glm::dot(way, q) / det;
    return u < 0 || v < 0 || u + v > 1 ? -1 : glm::dot(f, q) / det;
}

TEST(RayOracle, FirstHitsAreThoseOfAPlainLoop) {
    int hits = 0;
    for (unsigned seed = 0; seed < 4; ++seed) {
        const SceneView view = random_scene(seed, 64, 36);
        const RayOracle oracle(view.scene);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> value(-3, 3);
        for (int i = 0; i < 300; ++i) {
            const glm::dvec3 origin(value(random), value(random), value(random)),
                way(value(random), value(random), value(random));
            const auto found = oracle.find_first(origin, way, 0, 1, ~0u);
            long double nearest = 1;
            PixelIds ids;
            for (std::uint32_t k = 0; k < view.scene->instances.size(); ++k)
                for (std::uint32_t t = 0; t < view.scene->meshes[view.scene->instances[k].mesh]->triangles.size();
                     ++t) {
                    const long double at = solve(origin - oracle.get_origin(), way, oracle.get_corners({k, t}));
                    if (at > 0 && at < nearest) nearest = at, ids = {k, t};
                }
            ASSERT_EQ(found.has_value(), nearest < 1) << "seed " << seed << ", ray " << i;
            if (!found) continue;
            ++hits;
            EXPECT_NEAR(found->distance, double(nearest), 1e-12);
            EXPECT_EQ(found->ids.instance, ids.instance);
        }
    }
    EXPECT_GT(hits, 300);
}

/// Is the receiver shadowed? By a loop over all triangles in long double; nothing where it can't be told to 1e-9.
std::optional<bool> find_shadow(const RayOracle& oracle, const Scene& scene, const truth::Receiver& receiver,
                                const Light& light, const LightSample& sample) {
    const glm::dvec3 start = receiver.place_ws - oracle.get_origin();
    const glm::dvec3 way = sample.directional ? sample.to_light_ws : sample.position_ws - receiver.place_ws;
    bool blocked = false, unsure = false;
    for (std::uint32_t k = 0; k < scene.instances.size(); ++k) {
        if (!(scene.instances[k].flags & kInstanceShadow)) continue;
        if (!(light.blocker_set >> scene.instances[k].blocker_group & 1u)) continue;
        for (std::uint32_t t = 0; t < scene.meshes[scene.instances[k].mesh]->triangles.size(); ++t) {
            if (k == receiver.ids.instance && t == receiver.ids.triangle) continue;
            const auto corners = oracle.get_corners({k, t});
            // Corners moved outwards and inwards of the triangle's middle: where both agree, there is no doubt.
            const glm::dvec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            bool wide = false, narrow = false;
            for (const double size : {1 + 1e-9, 1 - 1e-9}) {
                auto moved = corners;
                for (glm::dvec3& corner : moved) corner = middle + size * (corner - middle);
                const long double at = solve(start, way, moved);
                const bool meets = at > 1e-9L && (sample.directional || at < 1 - 1e-9L);
                (size > 1 ? wide : narrow) = meets;
                unsure = unsure || (at > -1e-9L && at <= 1e-9L && at != -1);
            }
            blocked = blocked || narrow;
            unsure = unsure || wide != narrow;
        }
    }
    return blocked ? std::optional(true) : unsure ? std::nullopt : std::optional(false);
}

TEST(RayOracle, SightsAreThoseOfAPlainLoop) {
    std::size_t blocked = 0, open = 0, unsure = 0;
    for (const LightKind kind : {LightKind::Sun, LightKind::Point})
        for (unsigned seed = 1; seed <= 3; ++seed) {
            SceneView view = seed == 3 ? random_scene(3, 40, 24) : make_soup_scene(seed, 80, 45);
            view.scene->instances[1].blocker_group = 2;
            Light light = make_light(kind, {0.5, 0.8, 2.8}, {0, 0, 0.5});
            light.radius = 0.5, light.sun_angle = 0.5;
            if (seed == 3) light.blocker_set = ~std::uint64_t{4};
            const RayOracle oracle(view.scene);
            const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
            for (const LightSample& sample : sample_light_shape(light, 3, LightPattern::Spiral))
                for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
                    const auto receiver = oracle.find_receiver(frame, pixel);
                    if (!receiver) continue;
                    const truth::Sight sight = oracle.look(*receiver, light, sample);
                    const auto expected = find_shadow(oracle, *view.scene, *receiver, light, sample);
                    unsure += !expected || !sight.certain;
                    if (!expected || !sight.certain) continue;
                    ++(sight.blocked ? blocked : open);
                    EXPECT_EQ(sight.blocked, *expected) << "seed " << seed << ", pixel " << pixel;
                }
        }
    EXPECT_GT(std::min(blocked, open), 10000u);
    EXPECT_LT(unsure, (blocked + open) / 10000);
}

TEST(RayOracle, BoxShadowInClosedForm) {
    // A cube of side 2 floating from z = 1 to 3 over a floor, lit by a point light straight above.
    SceneView view;
    view.width = 200, view.height = 120;
    view.place(view.add("floor", make_plane(40)));
    view.place(view.add("cube", make_box({2, 2, 2})), placement({0, 0, 2}), kInstanceShadow);  // not seen itself
    view.camera = make_camera({1, -20, 30}, {0, 0, 0}, view.width, view.height, 40);
    const RayOracle oracle(view.scene);
    const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
    const double height = 7;
    for (const bool sun : {false, true}) {
        const Light light = make_light(sun ? LightKind::Sun : LightKind::Point, {0.5, 0.25, height}, {0.5, 0.25, 0});
        const auto positions = sample_light_shape(light, 1);
        const auto visibility = oracle.compute_visibility(frame, light, positions[0]);
        int shaded = 0;
        for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
            if (!frame.coverage[pixel]) continue;
            const glm::dvec3 p = frame.origin_ws + glm::dvec3(frame.positions_rel[pixel]);
            // The upper face is nearest to the light, so it casts the largest shadow; the sun's is the face itself.
            const double grow = sun ? 1 : height / (height - 3);
            const glm::dvec2 centre = sun ? glm::dvec2(0) : glm::dvec2(0.5, 0.25) * (1 - grow);
            const double outside = std::max(std::abs(p.x - centre.x), std::abs(p.y - centre.y)) - grow;
            if (std::abs(outside) < 1e-5) continue;
            EXPECT_EQ(visibility[pixel], outside < 0 ? 0 : 1) << p.x << ", " << p.y;
            shaded += visibility[pixel] == 0;
        }
        EXPECT_GT(shaded, 50);
    }
}

TEST(RayOracle, SurfacesDoNotShadeThemselves) {
    // A convex ball is lit exactly where its faces are turned to the light.
    SceneView view;
    view.width = 160, view.height = 90;
    view.place(view.add("ball", make_sphere(1, 48, 96)),
               glm::scale(placement({1e5, 3, -2}, 31, {1, 2, 3}), {2, 0.7, 1}));
    view.camera = make_camera({1e5 + 3, -3, 1}, {1e5, 3, -2}, view.width, view.height, 40);
    const RayOracle oracle(view.scene);
    const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
    const Light light = make_light(LightKind::Point, {1e5 + 6, 2, 6}, {1e5, 3, -2});
    const auto positions = sample_light_shape(light, 1);
    const auto visibility = oracle.compute_visibility(frame, light, positions[0]);
    int lit = 0, dark = 0;
    for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
        if (!frame.coverage[pixel]) continue;
        const glm::dvec3 to_light = positions[0].position_ws - frame.origin_ws - glm::dvec3(frame.positions_rel[pixel]);
        const double along = glm::dot(glm::dvec3(frame.normals[pixel]), glm::normalize(to_light));
        if (std::abs(along) < 1e-4) continue;
        EXPECT_EQ(visibility[pixel], along > 0 ? 1 : 0);
        ++(along > 0 ? lit : dark);
    }
    EXPECT_GT(lit, 300);
    EXPECT_GT(dark, 300);
}

}  // namespace
}  // namespace shadow_layers::testing
