// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>

#include "scene/bounds.h"
#include "shadow_layers/error.h"
#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

using testing::MeshData;
using testing::to_mesh;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

/// The text of the InputError that `act` throws; empty if it throws none.
std::string error_of(const std::function<void()>& act) {
    try {
        act();
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

/// Each word must stand in the text.
void expect_names(const std::string& text, std::initializer_list<const char*> words) {
    ASSERT_FALSE(text.empty()) << "no error";
    for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << "\"" << word << "\" in: " << text;
}

Scene scene_with_box() {
    Scene scene;
    scene.meshes.push_back(to_mesh("Crate", testing::make_box({1, 1, 1})));
    scene.instances.resize(3);
    scene.lights.resize(2);
    scene.lights[1].name = "Lamp";
    return scene;
}

TEST(MakeMesh, NamesMeshTriangleAndIndex) {
    const MeshData data{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 3}}};
    expect_names(error_of([&] { to_mesh("Crate", data); }), {"\"Crate\"", "triangle 1", "vertex 3", "3 vertices"});
}

TEST(MakeMesh, KeysFollowPositionsAndTopologyApart) {
    const MeshData box = testing::make_box({1, 1, 1});
    const auto plain = to_mesh("a", box), same = to_mesh("another name", box);
    EXPECT_EQ(plain->positions_key, same->positions_key);
    EXPECT_EQ(plain->topology_key, same->topology_key);
    MeshData moved = box;
    moved.positions[3].y += 1e-6f;
    EXPECT_NE(to_mesh("m", moved)->positions_key, plain->positions_key);
    EXPECT_EQ(to_mesh("m", moved)->topology_key, plain->topology_key);
    MeshData turned = box;
    std::swap(turned.triangles[0].x, turned.triangles[0].y);
    EXPECT_EQ(to_mesh("t", turned)->positions_key, plain->positions_key);
    EXPECT_NE(to_mesh("t", turned)->topology_key, plain->topology_key);
}

TEST(MakeMesh, BoundsLeaveOutWhatIsNotDrawn) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    // A loose vertex, a NaN, an infinite and an absurd one: only vertices 0 to 2 make geometry.
    const auto mesh =
        to_mesh("m", {{{0, 0, 0}, {1, 0, 0}, {0, 2, -3}, {50, 50, 50}, {nan, 0, 0}, {0, inf, 0}, {0, 0, 1e30f}},
                      {{0, 1, 2}, {0, 1, 4}, {0, 1, 5}, {0, 1, 6}}});
    EXPECT_EQ(mesh->bounds.min, glm::dvec3(0, 0, -3));
    EXPECT_EQ(mesh->bounds.max, glm::dvec3(1, 2, 0));
    EXPECT_TRUE(to_mesh("empty", {})->bounds.is_empty());
    EXPECT_TRUE(to_mesh("loose", {{{1, 2, 3}}, {}})->bounds.is_empty());
}

TEST(Bounds, TransformHoldsEveryCornerAndIsTightOnAxes) {
    const Bounds box{{-1, 0, 2}, {3, 1, 5}};
    glm::dmat4 matrix = glm::rotate(glm::translate(glm::dmat4(1), {1e6, -5, 2}), 0.7, glm::dvec3(1, 2, 3));
    matrix[1] *= -2.5;  // mirrored and stretched
    const Bounds moved = transform_bounds(box, matrix);
    Bounds exact;
    for (int k = 0; k < 8; ++k) exact.add(glm::dvec3(matrix * glm::dvec4(box_corner(box, k), 1)));
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(moved.min[axis], exact.min[axis], 1e-9);
        EXPECT_NEAR(moved.max[axis], exact.max[axis], 1e-9);
    }
    EXPECT_TRUE(transform_bounds(Bounds(), matrix).is_empty());
}

TEST(Validate, AcceptsWhatCanBeRendered) {
    EXPECT_NO_THROW(validate(Scene()));
    Scene scene = scene_with_box();
    EXPECT_NO_THROW(validate(scene));
    scene.instances[0].world_from_object = glm::dmat4(0.0);  // shrunk to a point
    scene.instances[0].world_from_object[3][3] = 1;
    scene.instances[1].world_from_object[0][0] = -1;  // mirrored
    scene.lights[0].kind = LightKind::Spot;
    scene.lights[0].spot_angle = std::numbers::pi;
    scene.lights[0].world_from_light[0][0] = -1;
    EXPECT_NO_THROW(validate(scene));
}

TEST(Validate, NamesTheInstanceAndItsMesh) {
    struct Case {
        std::function<void(Instance&)> spoil;
        std::initializer_list<const char*> words;
    };
    const Case cases[] = {
        {[](Instance& i) { i.mesh = 4; }, {"instance 2", "mesh is 4", "1 meshes"}},
        {[](Instance& i) { i.world_from_object[3][1] = kNan; },
         {"instance 2", "Crate", "world_from_object[1][3]", "nan"}},
        {[](Instance& i) { i.world_from_object[0][2] = kInf; },
         {"instance 2", "Crate", "world_from_object[2][0]", "inf"}},
        {[](Instance& i) { i.world_from_object[3][0] = 1e20; },
         {"instance 2", "Crate", "1e+20", "scale the scene down"}},
        {[](Instance& i) { i.world_from_object[2][3] = 0.5; }, {"instance 2", "last row", "0 0 0 1"}},
        {[](Instance& i) { i.receiver_group = 64; }, {"instance 2", "receiver_group is 64", "0 to 63"}},
        {[](Instance& i) { i.blocker_group = 200; }, {"instance 2", "blocker_group is 200"}},
    };
    for (const Case& c : cases) {
        Scene scene = scene_with_box();
        c.spoil(scene.instances[2]);
        expect_names(error_of([&] { validate(scene); }), c.words);
    }
    Scene scene = scene_with_box();
    scene.meshes.push_back(nullptr);
    expect_names(error_of([&] { validate(scene); }), {"mesh 1", "make_mesh"});
}

TEST(Validate, NamesTheLightAndTheField) {
    struct Case {
        std::function<void(Light&)> spoil;
        std::initializer_list<const char*> words;
    };
    const auto spot = [](double angle) {
        return [angle](Light& l) { l.kind = LightKind::Spot, l.spot_angle = angle; };
    };
    const Case cases[] = {
        {spot(0), {"light 1", "\"Lamp\"", "spot_angle is 0", "radians"}},
        {spot(-1), {"spot_angle is -1"}},
        {spot(3.3), {"spot_angle is 3.3"}},
        {spot(kNan), {"spot_angle is nan"}},
        {[](Light& l) { l.world_from_light[3][2] = kInf; }, {"light 1", "world_from_light[2][3]", "inf"}},
        {[](Light& l) { l.world_from_light[1] *= 2; }, {"light 1", "y axis", "length 2", "scale"}},
        {[](Light& l) {
             l.world_from_light[0] = {1, 0, 0.1, 0};
         },
         {"light 1", "axis"}},
        {[](Light& l) {
             l.world_from_light[2] = {0, 0, 0, 0};
         },
         {"z axis", "length 0"}},
        {[](Light& l) { l.radius = -1; }, {"radius is -1"}},
        {[](Light& l) { l.energy = kNan; }, {"energy is nan"}},
        {[](Light& l) { l.color.y = -2; }, {"color is -2"}},
        {[](Light& l) { l.sun_angle = 7; }, {"sun_angle is 7", "radians"}},
        {[](Light& l) { l.spot_blend = 1.5; }, {"spot_blend is 1.5"}},
        {[](Light& l) { l.area_size.y = kInf; }, {"area_size is inf"}},
        {[](Light& l) { l.kind = LightKind(9); }, {"kind"}},
    };
    for (const Case& c : cases) {
        Scene scene = scene_with_box();
        c.spoil(scene.lights[1]);
        expect_names(error_of([&] { validate(scene); }), c.words);
    }
}

TEST(Validate, NamesTheCameraField) {
    struct Case {
        std::function<void(Camera&)> spoil;
        std::initializer_list<const char*> words;
    };
    const Case cases[] = {
        {[](Camera& c) { c.window.right = c.window.left; }, {"camera", "window is empty", "right"}},
        {[](Camera& c) { c.window.top = -5; }, {"window is empty", "top"}},
        {[](Camera& c) { c.window.top = kNan; }, {"window.top is nan"}},
        {[](Camera& c) { c.clip_start = 0; }, {"clip_start is 0", "above 0"}},
        {[](Camera& c) { c.clip_end = 0.05; }, {"clip_end 0.05", "clip_start 0.1"}},
        {[](Camera& c) { c.clip_end = kInf; }, {"clip_end is inf"}},
        {[](Camera& c) { c.world_from_camera[0] *= 3; }, {"x axis", "length 3", "scale"}},
        {[](Camera& c) { c.world_from_camera[3][0] = kNan; }, {"world_from_camera[0][3]", "nan"}},
    };
    for (const Case& c : cases) {
        Camera camera;
        c.spoil(camera);
        expect_names(error_of([&] { validate(camera); }), c.words);
    }
    Camera flat;
    flat.perspective = false;
    flat.clip_start = -10;
    EXPECT_NO_THROW(validate(flat));
    EXPECT_NO_THROW(validate(Camera()));
}

}  // namespace
}  // namespace shadow_layers
