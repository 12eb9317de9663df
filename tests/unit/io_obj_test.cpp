// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "io/scene_file.h"
#include "unit/io_support.h"

namespace shadow_layers::test {
namespace {

class IoObj : public FolderTest {
protected:
    io::SceneFile read(const std::string& text) const { return io::read_scene_file(write("scene.obj", text)); }
};

constexpr const char* kBox =
    "mtllib missing.mtl\no box\nv 10 0 0\nv 12 0 0\nv 12 1 0\nv 10 1 0\nv 10 0 3\nv 12 0 3\nv 12 1 3\nv 10 1 3\n"
    "usemtl stone\nf 1 2 3 4\ng back\nf 5 6 7 8\nf -8 -4 -1\n";

TEST_F(IoObj, PolygonsAndRelativeIndicesBecomeOneMesh) {
    const io::SceneFile file = read(kBox);
    ASSERT_EQ(file.scene->meshes.size(), 1u);
    const Mesh& mesh = *file.scene->meshes[0];
    EXPECT_EQ(mesh.positions.size(), 8u);
    ASSERT_EQ(mesh.triangles.size(), 5u);
    EXPECT_EQ(mesh.triangles[4], glm::uvec3(0, 4, 7));
    EXPECT_EQ(mesh.positions[6], glm::vec3(12, 1, 3));
}

// Where a world point falls in the picture: x and y in [0, 1], and its depth.
glm::dvec3 project(const io::SceneFile& file, const glm::dvec3& point) {
    const glm::dvec4 p = glm::inverse(file.camera.world_from_camera) * glm::dvec4(point, 1);
    const double depth = -p.z, scale = file.camera.perspective ? 1 / depth : 1;
    const CameraWindow& window = file.camera.window;
    return {(p.x * scale - window.left) / (window.right - window.left),
            (p.y * scale - window.bottom) / (window.top - window.bottom), depth};
}

void expect_all_seen(const io::SceneFile& file) {
    for (const glm::vec3& position : file.scene->meshes[0]->positions) {
        const glm::dvec3 at = project(file, position);
        EXPECT_GT(at.x, 0);
        EXPECT_LT(at.x, 1);
        EXPECT_GT(at.y, 0);
        EXPECT_LT(at.y, 1);
        EXPECT_GT(at.z, file.camera.clip_start);
        EXPECT_LT(at.z, file.camera.clip_end);
    }
}

TEST_F(IoObj, TheDefaultCameraSeesEverythingInAnySize) {
    io::SceneFile file = read(kBox);
    expect_all_seen(file);
    for (const auto& [width, height] : {std::pair{300, 300}, {100, 800}, {1920, 1080}, {7, 3}}) {
        io::set_resolution(file, width, height);
        expect_all_seen(file);
        const CameraWindow& window = file.camera.window;
        EXPECT_NEAR((window.right - window.left) / width, (window.top - window.bottom) / height, 1e-12)
            << "pixels stay square";
    }
}

TEST_F(IoObj, TheDefaultSunShinesDownwards) {
    const io::SceneFile file = read(kBox);
    ASSERT_EQ(file.scene->lights.size(), 1u);
    const glm::dvec3 direction = -glm::dvec3(file.scene->lights[0].world_from_light[2]);
    EXPECT_LT(direction.y, -0.5);
    EXPECT_GT(glm::dot(direction, -glm::dvec3(file.camera.world_from_camera[2])), 0) << "from the viewer's side";
}

TEST_F(IoObj, AResolutionOfAnotherShapeKeepsWhatWasSeen) {
    io::SceneFile file;
    file.camera.window = {-1, 3, -0.5, 0.5};  // shifted; pixels twice as wide as high
    file.width = 200;
    file.height = 100;
    file.region = {1, 2, 3, 4};
    io::set_resolution(file, 100, 100);
    EXPECT_EQ(file.camera.window.left, -1);
    EXPECT_EQ(file.camera.window.right, 3);
    EXPECT_EQ(file.camera.window.bottom, -1);
    EXPECT_EQ(file.camera.window.top, 1);
    EXPECT_EQ(file.region.width, 0);
    io::set_resolution(file, 400, 100);
    EXPECT_EQ(file.camera.window.left, -7);
    EXPECT_EQ(file.camera.window.right, 9);
    EXPECT_EQ(file.camera.window.top, 1);
}

TEST_F(IoObj, BadFilesAreNamed) {
    for (const std::string& text :
         {std::string(), std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
          std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), std::string("v 0 0 0\nf 0 0 0\n"),
          std::string("v 0 0 0\nf -5 1 1\n"), std::string("\x89PNG\r\n\x1a\n\0\0\0", 11)}) {
        EXPECT_NE(error_of([&] { read(text); }).find("scene.obj"), std::string::npos) << text;
    }
}

TEST_F(IoObj, PointsThatAreNotFiniteDoNotMoveTheCamera) {
    const io::SceneFile file = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 1e39 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) EXPECT_TRUE(std::isfinite(file.camera.world_from_camera[c][r]));
    }
    EXPECT_LT(file.camera.clip_end, 100);
}

}  // namespace
}  // namespace shadow_layers::test
