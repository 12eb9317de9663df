// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/light_views.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <random>
#include <set>

#include "base/thread_pool.h"
#include "lights/facing.h"
#include "support/ray_oracle.h"
#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

using testing::RayOracle;
using testing::SceneView;

constexpr int kWidth = 160, kHeight = 90;

Frame frame_of(const SceneView& view) { return RayOracle(view.scene).make_frame(view.camera, view.width, view.height); }

Light light_of(LightKind kind, glm::dvec3 place, glm::dvec3 target, double spot_angle_deg = 60) {
    return testing::make_light(kind, place, target, spot_angle_deg);
}

/// The views of the light's centre, by value: a loop may go over them.
std::vector<LightView> make_views(const Frame& frame, const Light& light, const ViewSettings& settings) {
    return make_light_samples(frame, light, settings).at(0).views;
}

/// The same for a scene that is moved and scaled as a whole.
SceneView transform_view(const SceneView& view, double scale, const glm::dvec3& offset) {
    SceneView moved = view;
    moved.scene = std::make_shared<Scene>(*view.scene);
    glm::dmat4 matrix = glm::scale(glm::translate(glm::dmat4(1), offset), glm::dvec3(scale));
    for (Instance& instance : moved.scene->instances) instance.world_from_object = matrix * instance.world_from_object;
    moved.camera.world_from_camera[3] = matrix * view.camera.world_from_camera[3];
    moved.camera.clip_start *= scale, moved.camera.clip_end *= scale;
    return moved;
}

/// Place on the map, in texels with the border counted, and depth_rz.
glm::dvec3 map_place(const LightView& view, const glm::dvec3& point_ws) {
    const glm::dvec4 clip = view.lc_from_ws * glm::dvec4(point_ws, 1);
    return {(0.5 * clip.x / clip.w + 0.5) * view.size_texels, (0.5 * clip.y / clip.w + 0.5) * view.size_texels,
            clip.z / clip.w};
}

/// The views that a receiver may be looked up in: those of the faces that hold the greatest part of its direction.
std::vector<const LightView*> views_of(const LightSample& position, const glm::dvec3& point_ws) {
    std::vector<const LightView*> found;
    const glm::dvec3 local = glm::transpose(position.axes_ws) * (point_ws - position.position_ws);
    const glm::dvec3 reach = glm::abs(local);
    for (const LightView& view : position.views) {
        const int axis = view.face / 2;
        const double most = std::max({reach.x, reach.y, reach.z});
        if (position.choice.kind.x == kOneView || (reach[axis] == most && (local[axis] < 0) == (view.face % 2 == 1)))
            found.push_back(&view);
    }
    return found;
}

/// Every lit receiver lies on the map proper of every view it may be looked up in, in front of the far plane.
int expect_receivers_covered(const Frame& frame, const Light& light, const std::vector<LightSample>& positions) {
    int lit = 0;
    for (const LightSample& position : positions) {
        const FacingRule rule(frame, light, position);
        for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
            if (rule.classify(pixel) != Facing::Undecided) continue;
            ++lit;
            const glm::dvec3 point = frame.origin_ws + glm::dvec3(frame.positions_rel[pixel]);
            const auto views = views_of(position, point);
            EXPECT_FALSE(views.empty());
            for (const LightView* view : views) {
                const glm::dvec3 place = map_place(*view, point);
                const double spare = 0.3;
                EXPECT_GT(place.x, view->border_texels + spare);
                EXPECT_LT(place.x, view->size_texels - view->border_texels - spare);
                EXPECT_GT(place.y, view->border_texels + spare);
                EXPECT_LT(place.y, view->size_texels - view->border_texels - spare);
                EXPECT_GT(place.z, 0);
            }
            if (::testing::Test::HasFailure()) return lit;
        }
    }
    return lit;
}

/// Every instance that shades a receiver is a caster of its view, and no nearer than the near plane.
int expect_casters_found(const SceneView& view, const Frame& frame, const Light& light, const LightSample& position) {
    const RayOracle oracle(view.scene);
    const FacingRule rule(frame, light, position);
    int shaded = 0;
    for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
        if (rule.classify(pixel) != Facing::Undecided) continue;
        const glm::dvec3 point = frame.origin_ws + glm::dvec3(frame.positions_rel[pixel]);
        const glm::dvec3 way = position.directional ? position.to_light_ws : position.position_ws - point;
        const auto hit = oracle.find_first(point, way, 1e-5, position.directional ? 1e9 : 1, kInstanceShadow);
        if (!hit) continue;
        ++shaded;
        for (const LightView* map : views_of(position, point)) {
            EXPECT_TRUE(std::binary_search(map->casters.begin(), map->casters.end(), hit->ids.instance));
            EXPECT_LE(map_place(*map, point + hit->distance * way).z, 1 + 1e-9);
        }
        if (::testing::Test::HasFailure()) return shaded;
    }
    return shaded;
}

class LightViewsOfKind : public ::testing::TestWithParam<LightKind> {};
INSTANTIATE_TEST_SUITE_P(All, LightViewsOfKind,
                         ::testing::Values(LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area),
                         [](const auto& named) {
                             return std::string(std::array{"sun", "spot", "point", "area"}[std::size_t(named.param)]);
                         });

TEST_P(LightViewsOfKind, RandomScenesAreCovered) {
    int lit = 0, shaded = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
        const SceneView view = testing::random_scene(seed, kWidth, kHeight);
        const Frame frame = frame_of(view);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> value(-1, 1);
        const glm::dvec3 place(4 * value(random), 4 * value(random), 2.5 + 2 * value(random));
        Light light = light_of(GetParam(), place, {value(random), value(random), 0}, seed % 2 ? 50 : 150);
        light.radius = 0.1, light.sun_angle = 0.05;
        ViewSettings settings;
        settings.map_size = 64 << seed % 5;
        settings.border_texels = int(seed % 4);
        settings.sample_count = seed % 5 == 4 ? 3 : 1;
        const auto positions = make_light_samples(frame, light, settings);
        ASSERT_EQ(positions.size(), std::size_t(settings.sample_count));
        for (const LightSample& position : positions)
            for (const LightView& map : position.views) {
                EXPECT_EQ(map.size_texels, settings.map_size + 2 * settings.border_texels);
                EXPECT_LT(map.near_ls, map.far_ls);
            }
        lit += expect_receivers_covered(frame, light, positions);
        shaded += expect_casters_found(view, frame, light, positions.front());
        if (HasFailure()) FAIL() << "seed " << seed;
    }
    EXPECT_GT(lit, 10000);
    EXPECT_GT(shaded, 500);
}

TEST_P(LightViewsOfKind, MovedAndScaledScenesGiveTheSameTexels) {
    const SceneView view = testing::box_scene(kWidth, kHeight);
    const glm::dvec3 place(2.3, -1.7, 4.4), target(0.2, 0.1, 0.3);
    const Light light = light_of(GetParam(), place, target);
    const auto plain = make_light_samples(frame_of(view), light, {});
    ASSERT_FALSE(plain[0].views.empty());
    for (const auto& [scale, offset] :
         {std::pair(1e-4, glm::dvec3(0)), std::pair(1e6, glm::dvec3(0)), std::pair(1.0, glm::dvec3(1e6, -1e6, 1e6)),
          std::pair(1.0, glm::dvec3(0, 0, 7))}) {
        const SceneView moved = transform_view(view, scale, offset);
        const Light moved_light = light_of(GetParam(), place * scale + offset, target * scale + offset);
        const auto other = make_light_samples(frame_of(moved), moved_light, {});
        ASSERT_EQ(other[0].views.size(), plain[0].views.size());
        for (std::size_t i = 0; i < plain[0].views.size(); ++i) {
            EXPECT_EQ(other[0].views[i].casters, plain[0].views[i].casters);
            for (const glm::dvec3 point :
                 {glm::dvec3(0.5, 0.3, 0), glm::dvec3(-1, 0.4, 0.2), glm::dvec3(0.1, -0.1, 1.1)}) {
                const glm::dvec3 a = map_place(plain[0].views[i], point);
                const glm::dvec3 b = map_place(other[0].views[i], point * scale + offset);
                EXPECT_NEAR(a.x, b.x, 1e-3) << "scale " << scale;
                EXPECT_NEAR(a.y, b.y, 1e-3) << "scale " << scale;
                EXPECT_NEAR(a.z, b.z, 1e-4 * std::abs(a.z)) << "scale " << scale;
            }
        }
    }
}

TEST_P(LightViewsOfKind, ThreadsDoNotChangeTheResult) {
    const SceneView view = testing::random_scene(5, 320, 180);
    const Frame frame = frame_of(view);
    const Light light = light_of(GetParam(), {2, 1, 4}, {0, 0, 0});
    ThreadPool threads(3);
    const auto one = make_light_samples(frame, light, {}),
               many = make_light_samples(frame, light, {}, nullptr, &threads);
    ASSERT_EQ(one[0].views.size(), many[0].views.size());
    for (std::size_t i = 0; i < one[0].views.size(); ++i) EXPECT_EQ(one[0].views[i].key, many[0].views[i].key);
}

TEST_P(LightViewsOfKind, JitteredSamplesShareTheirViews) {
    const SceneView view = testing::random_scene(2, kWidth, kHeight);
    const Light light = light_of(GetParam(), {2, 1, 4}, {0, 0, 0});
    const RayOracle oracle(view.scene);
    std::vector<LightSample> previous;
    std::set<ContentKey> keys;
    std::size_t view_count = 0;
    for (int sample = 0; sample < 16; ++sample) {
        Camera camera = view.camera;
        const double dx = (camera.window.right - camera.window.left) / kWidth * (0.11 * (sample % 8) - 0.4);
        const double dy = (camera.window.top - camera.window.bottom) / kHeight * (0.23 * (sample % 4) - 0.4);
        camera.window.left += dx, camera.window.right += dx, camera.window.bottom += dy, camera.window.top += dy;
        const Frame frame = oracle.make_frame(camera, kWidth, kHeight);
        previous = make_light_samples(frame, light, {}, sample ? &previous : nullptr);
        expect_receivers_covered(frame, light, previous);
        for (const LightView& map : previous[0].views) keys.insert(map.key);
        view_count = std::max(view_count, previous[0].views.size());
    }
    EXPECT_LE(keys.size(), view_count + 4);  // a few are grown once; without sharing there would be 16 of each
}

TEST_P(LightViewsOfKind, ViewsOfAnotherSceneAreNotKept) {
    SceneView view = testing::box_scene(kWidth, kHeight);
    const std::uint32_t far_off = view.place(1, testing::placement({300, 0, 1}), kInstanceShadow);
    const Light light = light_of(GetParam(), {2.3, -1.7, 6.4}, {0.2, 0.1, 0.3});
    const auto before = make_light_samples(frame_of(view), light, {});
    const std::function<void(Scene&)> moves[] = {
        [&](Scene& s) { s.instances[1].world_from_object[3][0] += 0.02; },  // a caster within its view
        [&](Scene& s) {
            s.instances[far_off].world_from_object[3] = {1.2, -0.9, 3.5, 1};
        },                                                            // one that comes in, near the light
        [&](Scene& s) { s.instances[1].flags &= ~kInstanceShadow; },  // one that casts no longer
        [&](Scene& s) {
            s.meshes[1] = testing::to_mesh("box", testing::make_box({0.9f, 0.8f, 1.1f}));
        }};
    for (const auto& move : moves) {
        SceneView moved = view;
        moved.scene = std::make_shared<Scene>(*view.scene);
        move(*moved.scene);
        // The same receivers, so that the old views still cover them.
        Frame frame = frame_of(view);
        frame.scene = moved.scene;
        const auto fresh = make_light_samples(frame, light, {}), kept = make_light_samples(frame, light, {}, &before);
        ASSERT_EQ(kept[0].views.size(), fresh[0].views.size());
        for (std::size_t i = 0; i < fresh[0].views.size(); ++i) {
            EXPECT_EQ(kept[0].views[i].key, fresh[0].views[i].key);
            EXPECT_EQ(kept[0].views[i].casters, fresh[0].views[i].casters);
            EXPECT_EQ(kept[0].views[i].near_ls, fresh[0].views[i].near_ls);
        }
    }
}

TEST_P(LightViewsOfKind, KeysFollowWhatCastsAndNothingElse) {
    SceneView view = testing::box_scene(kWidth, kHeight);
    const std::uint32_t hidden = view.place(1, testing::placement({0, 0, 3}), kInstanceCamera);  // casts nothing
    view.place(1, testing::placement({0.4, 0.2, 2.4}), kInstanceShadow);
    const Light light = light_of(GetParam(), {2.3, -1.7, 6.4}, {0.2, 0.1, 0.3});
    const auto keys_of = [&](const SceneView& v) {
        std::set<ContentKey> keys;
        Frame frame = frame_of(view);  // the same receivers
        frame.scene = v.scene;
        for (const LightView& map : make_views(frame, light, {})) keys.insert(map.key);
        return keys;
    };
    const auto changed = [&](auto act) {
        SceneView other = view;
        other.scene = std::make_shared<Scene>(*view.scene);
        act(*other.scene);
        return keys_of(other) != keys_of(view);
    };
    EXPECT_FALSE(changed([&](Scene&) {}));
    EXPECT_FALSE(changed([&](Scene& s) { s.instances[hidden].receiver_group = 3; }));
    EXPECT_TRUE(changed([&](Scene& s) { s.instances[1].world_from_object[3][0] += 1e-3; }));
    EXPECT_TRUE(changed([&](Scene& s) { s.instances[1].flags &= ~kInstanceShadow; }));
    EXPECT_TRUE(changed([&](Scene& s) { s.instances[2].flags |= kInstanceShadow; }));
    EXPECT_TRUE(changed([&](Scene& s) {
        auto data = testing::make_box({1, 0.8f, 1.2f});
        data.positions[0] *= 0.99f;
        s.meshes[1] = testing::to_mesh("box", data);
    }));
}

TEST_P(LightViewsOfKind, BlockerSetChoosesCasters) {
    SceneView view = testing::box_scene(kWidth, kHeight);
    view.scene->instances[1].blocker_group = 5;
    Light light = light_of(GetParam(), {2.3, -1.7, 6.4}, {0.2, 0.1, 0.3});
    light.blocker_set = ~(std::uint64_t{1} << 5);
    for (const LightView& map : make_views(frame_of(view), light, {}))
        EXPECT_EQ(std::count(map.casters.begin(), map.casters.end(), 1u), 0);
    view.scene->instances[0].receiver_group = 7;
    view.scene->instances[1].receiver_group = 7;
    light.receiver_set = ~(std::uint64_t{1} << 7);
    EXPECT_TRUE(make_light_samples(frame_of(view), light, {})[0].views.empty());
}

TEST_P(LightViewsOfKind, OddSizesAndPlacesWork) {
    const SceneView view = testing::box_scene(kWidth, kHeight);
    const Frame frame = frame_of(view);
    const glm::dvec3 on_floor = frame.origin_ws + glm::dvec3(frame.positions_rel[frame.pixel_count() / 3]);
    const glm::dvec3 places[] = {{0.1, -0.05, 1.1},                             // in the box
                                 on_floor,                                      // at a receiver
                                 on_floor + glm::dvec3(0, 0, 1e-9),             // a hair above one
                                 glm::dvec3(view.camera.world_from_camera[3]),  // at the camera
                                 {0, 0, 0},                                     // in the plane of the floor
                                 {0, 0, -3}};                                   // behind it
    for (const glm::dvec3& place : places)
        for (const int map_size : {1, 2, 7, 8, 33}) {
            ViewSettings settings;
            settings.map_size = map_size;
            settings.border_texels = map_size % 3;
            const Light light = light_of(GetParam(), place, place + glm::dvec3(0.3, 0.2, -1));
            for (const LightSample& position : make_light_samples(frame, light, settings))
                for (const LightView& map : position.views) {
                    for (int i = 0; i < 4; ++i)
                        for (int j = 0; j < 4; ++j) ASSERT_TRUE(std::isfinite(map.lc_from_ws[i][j]));
                    EXPECT_LT(map.near_ls, map.far_ls);
                    if (position.directional) continue;
                    EXPECT_GT(map.near_ls, 0);
                }
        }
}

TEST(LightViews, NothingSeenGivesNoViews) {
    SceneView view = testing::box_scene(kWidth, kHeight);
    view.camera.world_from_camera = testing::look_at({0, 0, 50}, {0, 0, 100});
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        const auto positions = make_light_samples(frame_of(view), light_of(kind, {1, 1, 5}, {0, 0, 0}), {});
        ASSERT_EQ(positions.size(), 1u);
        EXPECT_TRUE(positions[0].views.empty());
    }
    SceneView empty;
    empty.width = kWidth, empty.height = kHeight;
    EXPECT_TRUE(
        make_light_samples(frame_of(empty), light_of(LightKind::Sun, {1, 1, 5}, {0, 0, 0}), {})[0].views.empty());
}

TEST(LightViews, DepthIsOneAtTheNearPlaneAndZeroAtTheFarPlane) {
    const SceneView view = testing::box_scene(kWidth, kHeight);
    const Frame frame = frame_of(view);
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point}) {
        for (const LightView& map : make_views(frame, light_of(kind, {2, 1, 5}, {0, 0, 0}), {})) {
            const auto depth = [&](double along) {
                const glm::dvec4 clip = map.lc_from_ls * glm::dvec4(0.1 * along, -0.05 * along, -along, 1);
                return clip.z / clip.w;
            };
            EXPECT_NEAR(depth(map.near_ls), 1, 1e-12);
            EXPECT_NEAR(depth(map.far_ls), 0, 1e-12);
            EXPECT_GT(depth(map.near_ls * 0.7 + map.far_ls * 0.3), depth(map.near_ls * 0.3 + map.far_ls * 0.7));
            const glm::dmat3 turn(map.ls_from_ws);
            EXPECT_NEAR(glm::determinant(turn), 1, 1e-12);  // rigid, not mirrored
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j) EXPECT_EQ(map.lc_from_ws[i][j], (map.lc_from_ls * map.ls_from_ws)[i][j]);
        }
    }
}

/// A frame made of points all round a light; every face of it looks at the light.
Frame surround(const glm::dvec3& light, const std::vector<glm::dvec3>& directions, std::shared_ptr<const Scene> scene) {
    Frame frame;
    frame.width = int(directions.size()), frame.height = 1;
    frame.origin_ws = light + glm::dvec3(3, -2, 1);
    frame.scene = std::move(scene);
    for (const glm::dvec3& direction : directions) {
        frame.positions_rel.push_back(glm::vec3(light + direction - frame.origin_ws));
        frame.normals.push_back(glm::vec3(-glm::normalize(direction)));
        frame.ids.push_back({0, 0});
        frame.coverage.push_back(1);
    }
    return frame;
}

TEST(LightViews, PointLightSweepsAcrossAllTwelveCubeEdges) {
    // Directions across each of the 12 edges of the cube, exactly on them, and through its 8 corners.
    std::vector<glm::dvec3> directions;
    for (int axis = 0; axis < 3; ++axis)
        for (const double s : {-1.0, 1.0})
            for (const double t : {-1.0, 1.0})
                for (int along = -20; along <= 20; ++along)
                    for (const double off : {-1e-2, -1e-5, -1e-7, 0.0, 1e-7, 1e-5, 1e-2}) {
                        glm::dvec3 d;
                        d[axis] = along / 20.0, d[(axis + 1) % 3] = s, d[(axis + 2) % 3] = t * (1 + off);
                        directions.push_back(2.0 * d);
                    }
    const SceneView room = [] {
        SceneView view;
        view.place(view.add("room", testing::make_box({8, 8, 8})));
        return view;
    }();
    for (const glm::dvec3 place : {glm::dvec3(0), glm::dvec3(0.5, -0.25, 0.125)}) {
        const Frame frame = surround(place, directions, room.scene);
        const Light light = light_of(LightKind::Point, place, place + glm::dvec3(0.3, 0.4, -1));
        const auto positions = make_light_samples(frame, light, {});
        ASSERT_EQ(positions[0].views.size(), 6u);
        EXPECT_EQ(expect_receivers_covered(frame, light, positions), int(directions.size()));
        // A shader in float may choose either neighbour within rounding: both must hold the receiver.
        for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
            const glm::dvec3 point = frame.origin_ws + glm::dvec3(frame.positions_rel[pixel]);
            const glm::dvec3 d = point - place, reach = glm::abs(d);
            for (const LightView& map : positions[0].views) {
                const int axis = map.face / 2;
                if ((d[axis] < 0) != (map.face % 2 == 1)) continue;
                if (reach[axis] < (1 - 2e-6) * std::max({reach.x, reach.y, reach.z})) continue;
                const glm::dvec3 on_map = map_place(map, point);
                EXPECT_GT(std::min({on_map.x, on_map.y, map.size_texels - on_map.x, map.size_texels - on_map.y}), 0.3);
            }
        }
    }
}

TEST(LightViews, OnlyFacesWithReceiversAreMade) {
    const SceneView view = testing::box_scene(kWidth, kHeight);
    const Frame frame = frame_of(view);
    // High above everything, only the lower face sees receivers.
    const auto high = make_light_samples(frame, light_of(LightKind::Point, {0, 0, 60}, {0, 0, 0}), {});
    ASSERT_EQ(high[0].views.size(), 1u);
    EXPECT_EQ(high[0].views[0].face, 5);
    // An area light that looks up lights nothing of a floor below.
    EXPECT_TRUE(make_light_samples(frame, light_of(LightKind::Area, {0, 0, 6}, {0, 0.1, 9}), {})[0].views.empty());
    // A narrow spot has one view, a wide one cube faces, all in front.
    const auto kind_of_spot = [&](double angle_deg) {
        return make_light_samples(frame, light_of(LightKind::Spot, {0, 0, 3}, {0, 0, 0}, angle_deg), {})[0]
            .choice.kind.x;
    };
    EXPECT_EQ(kind_of_spot(119), kOneView);
    EXPECT_EQ(kind_of_spot(121), kCubeFaces);
}

TEST(LightViews, FitIsTight) {
    const SceneView view = testing::box_scene(kWidth, kHeight);
    const Frame frame = frame_of(view);
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point}) {
        const Light light = light_of(kind, {2.3, -1.7, 6.4}, {0.2, 0.1, 0.3});
        const auto positions = make_light_samples(frame, light, {});
        const FacingRule rule(frame, light, positions[0]);
        for (const LightView& map : positions[0].views) {
            glm::dvec2 low(1e9), high(-1e9);
            for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
                if (rule.classify(pixel) != Facing::Undecided) continue;
                const glm::dvec3 point = frame.origin_ws + glm::dvec3(frame.positions_rel[pixel]);
                const auto views = views_of(positions[0], point);
                if (std::find(views.begin(), views.end(), &map) == views.end()) continue;
                low = glm::min(low, glm::dvec2(map_place(map, point)));
                high = glm::max(high, glm::dvec2(map_place(map, point)));
            }
            EXPECT_GT(high.x - low.x, 1024 / 1.05 - 3);  // one step of 2^(1/16), and the spare texels
            EXPECT_GT(high.y - low.y, 1024 / 1.05 - 3);
        }
    }
}

TEST(LightViews, TexelsRestWhileTheCameraMoves) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point}) {
        const Light light = light_of(kind, {2.3, -1.7, 6.4}, {0.2, 0.1, 0.3});
        int same_size = 0;
        std::vector<LightSample> before;
        for (int step = 0; step < 40; ++step) {
            SceneView view = testing::box_scene(kWidth, kHeight);
            view.camera =
                testing::make_camera({3.2 + 0.004 * step, -4.1, 3.4}, {0.3 + 0.004 * step, 0.3, 0.3}, kWidth, kHeight);
            const auto now = make_light_samples(frame_of(view), light, {});
            for (std::size_t i = 0; i < now[0].views.size() && step > 0; ++i) {
                if (i >= before[0].views.size() || before[0].views[i].face != now[0].views[i].face) continue;
                const LightView &a = before[0].views[i], &b = now[0].views[i];
                if (std::abs(a.lc_from_ls[0][0] / b.lc_from_ls[0][0] - 1) > 1e-9) continue;
                if (std::abs(a.lc_from_ls[1][1] / b.lc_from_ls[1][1] - 1) > 1e-9) continue;
                ++same_size;
                const glm::dvec3 moved = map_place(b, {0.2, 0.3, 0.1}) - map_place(a, {0.2, 0.3, 0.1});
                EXPECT_NEAR(moved.x, std::round(moved.x), 1e-6);
                EXPECT_NEAR(moved.y, std::round(moved.y), 1e-6);
            }
            before = now;
        }
        EXPECT_GT(same_size, 30);  // the size itself seldom changes
    }
}

TEST(LightViews, FarSpotEndsAsASun) {
    const SceneView view = testing::box_scene(kWidth, kHeight);
    const Frame frame = frame_of(view);
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0.5, -0.3, 1.2));
    const auto sun = make_light_samples(frame, light_of(LightKind::Sun, towards, {0, 0, 0}), {});
    const LightView& sun_view = sun[0].views.at(0);
    for (const double distance : {1e5, 1e6, 1e7, 1e9}) {
        const auto spot = make_light_samples(
            frame, light_of(LightKind::Spot, towards * distance, {0, 0, 0}, glm::degrees(40 / distance)), {});
        const LightView& spot_view = spot[0].views.at(0);
        EXPECT_EQ(spot_view.casters, sun_view.casters);
        for (const glm::dvec3 point : {glm::dvec3(0.5, 0.3, 0), glm::dvec3(-1, 0.4, 0.2), glm::dvec3(0.1, -0.1, 1.1)}) {
            const glm::dvec3 a = map_place(sun_view, point), b = map_place(spot_view, point);
            const double bend = 2e4 / distance;  // perspective itself
            EXPECT_NEAR(a.x, b.x, bend + 1e-2) << distance;
            EXPECT_NEAR(a.y, b.y, bend + 1e-2) << distance;
            EXPECT_NEAR(a.z, b.z, 1e2 / distance + 1e-6) << distance;
        }
    }
}

TEST(LightViews, FlatScenesGetAMapWithAnArea) {
    SceneView view;
    view.width = kWidth, view.height = kHeight;
    view.place(view.add("floor", testing::make_plane(4)));
    view.camera = testing::make_camera({0, -3, 3}, {0, 0, 0}, kWidth, kHeight);
    const Frame frame = frame_of(view);
    // From straight above the floor has no depth; at a low sun it has almost no height on the map.
    for (const glm::dvec3 towards : {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 1e-6), glm::dvec3(0.3, 0.2, 0.4)}) {
        const Light light = light_of(LightKind::Sun, towards, {0, 0, 0});
        const auto positions = make_light_samples(frame, light, {});
        ASSERT_EQ(positions[0].views.size(), 1u);
        EXPECT_GT(expect_receivers_covered(frame, light, positions), 1000);
    }
}

}  // namespace
}  // namespace shadow_layers
