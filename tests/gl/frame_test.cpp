// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The frame against closed forms and against rays: frame/.
#include <cmath>
#include <random>

#include "frame/camera_window.h"
#include "frame/frame_maker.h"
#include "gl/texture.h"
#include "gl_fixture.h"
#include "support/ray_oracle.h"

namespace shadow_layers {
namespace {

class FrameTest : public test::EngineTest {
protected:
    std::shared_ptr<const Frame> make_frame(std::shared_ptr<const Scene> scene, const Camera& camera, int width,
                                            int height, PixelRect region = {}, int overscan_px = 0,
                                            glm::dvec2 offset_px = glm::dvec2(0.0)) {
        if (region.width == 0) region = {0, 0, width, height};
        FrameMaker maker(engine(), pool_, {std::move(scene), camera, width, height, region, overscan_px});
        return maker.make(offset_px);
    }
    void TearDown() override {
        pool_.reset();
        EngineTest::TearDown();
    }
    std::shared_ptr<FramePool> pool_ = std::make_shared<FramePool>();
};

std::shared_ptr<Scene> make_scene(test::MeshData mesh, const glm::dmat4& world_from_object) {
    auto scene = std::make_shared<Scene>();
    scene->meshes = {test::to_mesh("mesh", std::move(mesh))};
    Instance instance;
    instance.world_from_object = world_from_object;
    scene->instances = {instance};
    return scene;
}

Camera scale_camera(Camera camera, double scale, const glm::dvec3& offset) {
    camera.world_from_camera[3] = glm::dvec4(glm::dvec3(camera.world_from_camera[3]) * scale + offset, 1);
    camera.clip_start *= scale;
    camera.clip_end *= scale;
    if (!camera.perspective)
        camera.window = {camera.window.left * scale, camera.window.right * scale, camera.window.bottom * scale,
                         camera.window.top * scale};
    return camera;
}

TEST_F(FrameTest, PositionsLieOnTheFloorUnderThePixelsRay) {
    const Camera camera = test::make_camera({3, -4, 2}, {0, 0, 0}, 1.0, 96, 64);
    const auto frame = make_frame(make_scene(test::make_quad(50), glm::dmat4(1.0)), camera, 96, 64);
    int covered = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 96; ++x) {
            const std::size_t pixel = std::size_t(y) * 96 + std::size_t(x);
            if (!frame->coverage[pixel]) continue;
            ++covered;
            const auto ray = testing::compute_pixel_ray(camera, x + 0.5, y + 0.5, 96, 64);
            const double depth = -ray.origin_ws.z / ray.direction.z;
            const glm::dvec3 expected = depth * ray.direction;
            EXPECT_LE(glm::length(glm::dvec3(frame->positions_rel[pixel]) - expected), 1e-7 * glm::length(expected));
            EXPECT_EQ(frame->normals[pixel], glm::vec3(0, 0, 1));
        }
    EXPECT_GT(covered, 3000);
}

/// Row 0 is the bottom row and x grows to the right: the floor fills the lower part, a block stands on the right.
TEST_F(FrameTest, RowsRiseAndColumnsGoRight) {
    auto scene = make_scene(test::make_quad(1), glm::translate(glm::dmat4(1.0), {2, 0, 0}) *
                                                    glm::rotate(glm::dmat4(1.0), M_PI / 2, {1, 0, 0}));
    const Camera camera = test::make_camera({0, -10, 1.2}, {0, 0, 1.2}, 1.0, 64, 64);
    const auto frame = make_frame(scene, camera, 64, 64);
    const auto covers = [&](int x, int y) { return int(frame->coverage[std::size_t(y) * 64 + std::size_t(x)]); };
    EXPECT_EQ(covers(44, 25), 1);
    EXPECT_EQ(covers(20, 25), 0);
    EXPECT_EQ(covers(44, 45), 0);
}

struct Placing {
    double scale;
    glm::dvec3 offset;
    bool perspective;
};

class FramePlacing : public FrameTest, public ::testing::WithParamInterface<Placing> {};

/// Scale and place must not matter: ids alike, positions right to the last digits of a float.
TEST_P(FramePlacing, BallAgreesWithRays) {
    const auto [scale, offset, perspective] = GetParam();
    constexpr int kWidth = 120, kHeight = 90;
    Camera camera = test::make_camera({3, -2, 2}, {0, 0, 0}, 0.8, kWidth, kHeight, 0.01, 100);
    if (!perspective) {
        camera.perspective = false;
        camera.window = {-1.6, 1.6, -1.2, 1.2};
    }
    const glm::dmat4 placed = glm::scale(glm::translate(glm::dmat4(1.0), offset), glm::dvec3(scale));
    const auto scene = make_scene(test::make_ball(48, 96), placed);
    camera = scale_camera(camera, scale, offset);
    const auto frame = make_frame(scene, camera, kWidth, kHeight);
    const testing::RayOracle oracle(scene);
    const Frame truth = oracle.make_frame(camera, kWidth, kHeight);
    int covered = 0, other_id = 0, other_coverage = 0;
    for (std::size_t i = 0; i < frame->pixel_count(); ++i) {
        other_coverage += frame->coverage[i] != truth.coverage[i];
        if (!frame->coverage[i] || !truth.coverage[i]) continue;
        ++covered;
        if (frame->ids[i].triangle != truth.ids[i].triangle) {
            ++other_id;
            continue;
        }
        const double distance = glm::length(glm::dvec3(truth.positions_rel[i]));
        EXPECT_LE(glm::length(glm::dvec3(frame->positions_rel[i]) - glm::dvec3(truth.positions_rel[i])),
                  3e-7 * distance);
        EXPECT_GE(glm::dot(frame->normals[i], truth.normals[i]), 1 - 1e-5f);
    }
    EXPECT_GT(covered, 3000);
    EXPECT_EQ(other_id, 0);
    EXPECT_LE(other_coverage, 4);
}

INSTANTIATE_TEST_SUITE_P(ScalesAndOffsets, FramePlacing,
                         ::testing::Values(Placing{1, {0, 0, 0}, true}, Placing{1e-4, {0, 0, 0}, true},
                                           Placing{1e6, {0, 0, 0}, true}, Placing{1, {1e6, -1e6, 1e6}, true},
                                           Placing{1, {0, 0, 0}, false}, Placing{1e-4, {0, 0, 0}, false},
                                           Placing{1e6, {0, 0, 0}, false}, Placing{1, {1e6, -1e6, 1e6}, false}));

/// A ball far from its own origin: the vertices' float steps are all that is lost.
TEST_F(FrameTest, LargeObjectCoordinatesCancel) {
    test::MeshData far_ball = test::make_ball(24, 48);
    for (glm::vec3& p : far_ball.positions) p += glm::vec3(4096, 8192, -2048);  // steps of 1/1024 at most
    const auto scene = make_scene(far_ball, glm::translate(glm::dmat4(1.0), {-4096, -8192, 2048}));
    const Camera camera = test::make_camera({3, -2, 2}, {0, 0, 0}, 0.8, 120, 90);
    const auto frame = make_frame(scene, camera, 120, 90);
    const Frame truth = testing::RayOracle(scene).make_frame(camera, 120, 90);
    for (std::size_t i = 0; i < frame->pixel_count(); ++i)
        if (frame->ids[i].triangle == truth.ids[i].triangle && truth.coverage[i]) {
            EXPECT_LE(glm::length(frame->positions_rel[i] - truth.positions_rel[i]), 2e-6f);
        }
}

class FrameFov : public FrameTest, public ::testing::WithParamInterface<double> {};

/// A wall across the view, at any field of view: its depth is known in every pixel.
TEST_P(FrameFov, WallHasItsDepthEverywhere) {
    const double fov = GetParam() * M_PI / 180;
    const Camera camera = test::make_camera({0, 0, 5}, {0, 0, 0}, fov, 128, 128);
    const auto frame = make_frame(make_scene(test::make_quad(200), glm::dmat4(1.0)), camera, 128, 128);
    for (std::size_t i = 0; i < frame->pixel_count(); ++i) {
        ASSERT_EQ(frame->coverage[i], 1);
        EXPECT_NEAR(frame->positions_rel[i].z, -5, 1e-6);
        const double x = (double(i % 128) + 0.5) / 64 - 1;
        EXPECT_NEAR(frame->positions_rel[i].x, 5 * std::tan(fov / 2) * x, 1e-6 * (1 + std::abs(5 * std::tan(fov / 2))));
    }
}

INSTANTIATE_TEST_SUITE_P(Degrees, FrameFov, ::testing::Values(0.5, 1.0, 10.0, 90.0, 150.0, 170.0));

TEST_F(FrameTest, RayAtMeetsThePositions) {
    for (bool perspective : {true, false}) {
        Camera camera = test::make_camera({3, -4, 2}, {0, 0, 0}, 1.0, 64, 48);
        camera.perspective = perspective;
        if (!perspective) camera.window = {-3, 3, -2.25, 2.25};
        const auto frame = make_frame(test::make_ball_scene(), camera, 64, 48, {5, 7, 40, 30}, 4, {0.25, -0.4});
        for (int y = 0; y < frame->height; ++y)
            for (int x = 0; x < frame->width; ++x) {
                const std::size_t pixel = std::size_t(y * frame->width + x);
                if (!frame->coverage[pixel]) continue;
                const Frame::Ray ray = frame->ray_at(x + 0.5, y + 0.5);
                const glm::dvec3 to_point = glm::dvec3(frame->positions_rel[pixel]) - ray.origin_rel;
                const double off = glm::length(glm::cross(to_point, glm::normalize(ray.direction)));
                EXPECT_LE(off, 1e-6 * glm::length(to_point));
            }
    }
}

TEST_F(FrameTest, RegionAndOverscanCutTheSamePicture) {
    const Camera camera = test::make_camera({6, -7, 5}, {0, 0, 0.7}, 0.9, 80, 60);
    const auto scene = test::make_ball_scene();
    const auto whole = make_frame(scene, camera, 80, 60);
    const auto part = make_frame(scene, camera, 80, 60, {20, 10, 30, 25}, 6);
    EXPECT_EQ(part->width, 42);
    EXPECT_EQ(part->height, 37);
    int other = 0;
    for (int y = 0; y < part->height; ++y)
        for (int x = 0; x < part->width; ++x) {
            const int full_x = x - 6 + 20, full_y = y - 6 + 10;
            const std::size_t a = std::size_t(y * 42 + x), b = std::size_t(full_y * 80 + full_x);
            if (part->ids[a].triangle != whole->ids[b].triangle || part->ids[a].instance != whole->ids[b].instance) {
                ++other;
                continue;
            }
            EXPECT_LE(glm::length(part->positions_rel[a] - whole->positions_rel[b]), 1e-5f);
        }
    EXPECT_LE(other, 8);  // centres that lie on an edge
}

TEST_F(FrameTest, OffsetsMoveTheSamplePoint) {
    const Camera camera = test::make_camera({0, 0, 5}, {0, 0, 0}, 1.0, 64, 64);
    const auto scene = make_scene(test::make_quad(20), glm::dmat4(1.0));
    FrameMaker maker(engine(), pool_, {scene, camera, 64, 64, {0, 0, 64, 64}, 0});
    SampleFrames frames(maker, {0.125, 0});
    const auto moved = frames.at_offset(0.25, -0.5);
    const double pixel = 10 * std::tan(0.5) / 64;
    const glm::vec3 step = moved->positions_rel[100] - frames.centre().positions_rel[100];
    EXPECT_NEAR(step.x, 0.25 * pixel, 1e-6);
    EXPECT_NEAR(step.y, -0.5 * pixel, 1e-6);
    EXPECT_EQ(frames.at_offset(0.25, -0.5), moved);  // kept
    EXPECT_NE(frames.at_offset(0.25, 0.5)->key, moved->key);
    EXPECT_THROW(frames.at_offset(0.6, 0), Error);
}

TEST_F(FrameTest, KeptFramesStayInTheBudget) {
    const auto scene = test::make_ball_scene();
    const Camera camera = test::make_camera({6, -7, 5}, {0, 0, 0.7}, 0.9, 256, 256);
    const std::size_t frame_bytes = 256 * 256 * (2 * 12 + 8 + 1 + 2 * 16);
    FrameMaker maker(engine(), pool_, {scene, camera, 256, 256, {0, 0, 256, 256}, 0}, 3 * frame_bytes);
    std::size_t most = 0;
    for (int i = 0; i < 12; ++i) {
        maker.make({i * 0.01, 0});
        most = std::max(most, engine().gpu_bytes());
    }
    EXPECT_LE(most, 12u * 256 * 256 * 16);
    // Made again, the same bytes.
    const auto again = maker.make({0, 0});
    const std::vector<glm::vec3> positions = again->positions_rel;
    for (int i = 1; i < 6; ++i) maker.make({i * 0.02, 0.1});
    EXPECT_EQ(maker.make({0, 0})->positions_rel, positions);
}

TEST_F(FrameTest, TexturesHoldTheArraysAndTheGroup) {
    const auto scene = test::make_ball_scene();
    scene->instances[1].receiver_group = 37;
    const auto frame = make_frame(scene, test::make_camera({6, -7, 5}, {0, 0, 0.7}, 0.9, 80, 60), 80, 60);
    const auto positions = frame->position_tx->download<glm::vec4>();
    const auto normals = frame->normal_tx->download<glm::vec4>();
    int grouped = 0;
    for (std::size_t i = 0; i < frame->pixel_count(); ++i) {
        EXPECT_EQ(positions[i], glm::vec4(frame->positions_rel[i], float(frame->coverage[i])));
        EXPECT_EQ(glm::vec3(normals[i]), frame->normals[i]);
        grouped += normals[i].w == 37;
        if (frame->coverage[i]) {
            EXPECT_EQ(normals[i].w, frame->ids[i].instance == 1 ? 37 : 0);
        }
    }
    EXPECT_GT(grouped, 50);
}

TEST_F(FrameTest, HoldoutsAreHolesThatKeepTheirIds) {
    const auto scene = test::make_ball_scene();
    scene->instances[1].flags |= kInstanceHoldout;
    const auto frame = make_frame(scene, test::make_camera({6, -7, 5}, {0, 0, 0.7}, 0.9, 80, 60), 80, 60);
    int holes = 0;
    for (std::size_t i = 0; i < frame->pixel_count(); ++i) {
        if (frame->ids[i].instance != 1) continue;
        ++holes;
        EXPECT_EQ(frame->coverage[i], 0);
        EXPECT_EQ(frame->positions_rel[i], glm::vec3(0));
    }
    EXPECT_GT(holes, 50);
}

TEST_F(FrameTest, InstancesHiddenFromTheCameraAreNotSeen) {
    const auto scene = test::make_ball_scene();
    scene->instances[1].flags = kInstanceShadow;
    const auto frame = make_frame(scene, test::make_camera({6, -7, 5}, {0, 0, 0.7}, 0.9, 80, 60), 80, 60);
    for (const PixelIds& ids : frame->ids) EXPECT_NE(ids.instance, 1u);
}

TEST_F(FrameTest, ClipPlanesCut) {
    Camera camera = test::make_camera({0, 0, 5}, {0, 0, 0}, 1.0, 32, 32);
    const auto scene = make_scene(test::make_quad(20), glm::dmat4(1.0));
    const auto covered = [&](double clip_start, double clip_end) {
        camera.clip_start = clip_start;
        camera.clip_end = clip_end;
        const auto frame = make_frame(scene, camera, 32, 32);
        return std::count(frame->coverage.begin(), frame->coverage.end(), 1);
    };
    EXPECT_EQ(covered(0.1, 5.001), 32 * 32);
    EXPECT_EQ(covered(0.1, 4.999), 0);
    EXPECT_EQ(covered(5.001, 100), 0);
    EXPECT_EQ(covered(4.999, 100), 32 * 32);
}

/// Where triangles are smaller than pixels, hundreds of centres fall to a neighbour by the raster's grid.
TEST_F(FrameTest, PixelsSeeTheTriangleThatTheirRayMeets) {
    const auto scene = make_scene(test::make_ball(700, 1400), glm::dmat4(1.0));
    for (const bool perspective : {true, false}) {
        Camera camera = test::make_camera({3, -2, 2}, {0, 0, 0}, 0.8, 160, 120, 0.01, 100);
        camera.perspective = perspective;
        if (!perspective) camera.window = {-1.6, 1.6, -1.2, 1.2};
        const auto frame = make_frame(scene, camera, 160, 120);
        const Frame truth = testing::RayOracle(scene).make_frame(camera, 160, 120);
        int covered = 0, other = 0;
        for (std::size_t i = 0; i < frame->pixel_count(); ++i) {
            if (!frame->coverage[i] || !truth.coverage[i]) continue;
            ++covered;
            other += frame->ids[i].triangle != truth.ids[i].triangle;
        }
        EXPECT_GT(covered, 5000);
        EXPECT_LE(other, 2);
    }
}

/// Degenerate, mirrored, flattened and not finite: finite values everywhere, unit normals towards the camera.
TEST_F(FrameTest, BadGeometryGivesFiniteFrames) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> spread(-1, 1);
    test::MeshData soup;
    for (int i = 0; i < 900; ++i) soup.positions.emplace_back(spread(random), spread(random), spread(random));
    soup.positions.emplace_back(NAN, 0, 0);
    soup.positions.emplace_back(INFINITY, 0, 0);
    for (std::uint32_t i = 0; i < 300; ++i) soup.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    for (std::uint32_t i = 0; i < 50; ++i) {
        soup.triangles.emplace_back(i, i, i + 1);    // no area
        soup.triangles.emplace_back(i, i + 1, 900);  // not a number
        soup.triangles.emplace_back(901, i, i + 1);  // infinite
        soup.positions.push_back(0.5f * (soup.positions[i] + soup.positions[i + 1]));
        soup.triangles.emplace_back(i, i + 1, 902 + i);  // on a line, nearly
    }
    auto scene = make_scene(soup, glm::dmat4(1.0));
    for (const glm::dvec3& scale : {glm::dvec3(-1, 1, 1), glm::dvec3(1, 1, 0), glm::dvec3(1e-30), glm::dvec3(1e12)}) {
        Instance instance;
        instance.world_from_object = glm::scale(glm::dmat4(1.0), scale);
        scene->instances.push_back(instance);
    }
    for (const glm::dvec3& eye : {glm::dvec3(3, -2, 2), glm::dvec3(0.1, 0, 0), glm::dvec3(5, 0, 0)}) {
        const auto frame = make_frame(scene, test::make_camera(eye, {0, 0, 0}, 1.0, 64, 48, 1e-3, 1e4), 64, 48);
        for (std::size_t i = 0; i < frame->pixel_count(); ++i) {
            const glm::vec3& p = frame->positions_rel[i];
            ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
            if (!frame->coverage[i]) continue;
            ASSERT_NEAR(glm::length(frame->normals[i]), 1, 1e-5);
            ASSERT_LE(glm::dot(frame->normals[i], p), 1e-6f * glm::length(p));
            const std::uint32_t triangle = frame->ids[i].triangle;
            ASSERT_TRUE(triangle < 300 || (triangle - 300) % 4 == 3) << triangle;
        }
    }
    const auto warnings = engine().take_warnings();
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("100 of 500"), std::string::npos) << warnings[0];
}

TEST_F(FrameTest, EmptyScenesAreBackground) {
    const Camera camera = test::make_camera({0, 0, 5}, {0, 0, 0}, 1.0, 16, 16);
    auto scene = std::make_shared<Scene>();
    const auto count = [&] {
        const auto frame = make_frame(scene, camera, 16, 16);
        for (const PixelIds& ids : frame->ids) EXPECT_EQ(ids.instance, kNoId);
        return std::count(frame->coverage.begin(), frame->coverage.end(), 1);
    };
    EXPECT_EQ(count(), 0);
    scene->meshes = {test::to_mesh("nothing", {})};
    scene->instances = {Instance{}};
    EXPECT_EQ(count(), 0);
}

}  // namespace
}  // namespace shadow_layers
