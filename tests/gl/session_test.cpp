// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The session as callers see it: pictures, order, errors, cancelling, closing, memory.
#include "shadow_layers/session.h"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "gl_fixture.h"
#include "support/technique_scenes.h"

namespace shadow_layers {
namespace {

using Clock = std::chrono::steady_clock;

class SessionTest : public ::testing::Test {
protected:
    // One for all tests of the suite: making it is the slow part, and using it again after errors is the point.
    static void SetUpTestSuite() { session_ = std::make_unique<Session>(test::make_session_options()); }
    static void TearDownTestSuite() { session_.reset(); }
    static Session& session() { return *session_; }

    static std::vector<Layer> render_layers(const RenderRequest& request, FrameResult* frame = nullptr) {
        std::vector<Layer> layers;
        FrameResult result = session().render(request, [&](Layer&& layer) { layers.push_back(std::move(layer)); });
        if (frame) *frame = std::move(result);
        return layers;
    }
    static std::string message_of(const RenderRequest& request) {
        try {
            session().render(request, {});
        } catch (const InputError& error) {
            return error.what();
        }
        return "nothing was thrown";
    }
    static RenderRequest make_request(int width = 160, int height = 90) {
        RenderRequest request = test::make_request(test::make_ball_scene(), width, height);
        request.jobs = {{0, "sm", {}}};
        return request;
    }
    /// Many samples of many lights: tens of seconds if nobody stops it.
    static RenderRequest make_long_request() {
        RenderRequest request = make_request(1280, 720);
        auto scene = test::make_ball_scene();
        for (int i = 0; i < 40; ++i) scene->lights.push_back(scene->lights[0]);
        request.scene = scene;
        request.samples = 64;
        request.jobs.clear();
        for (std::uint32_t i = 0; i < 40; ++i) request.jobs.push_back({i, "sm", {}});
        return request;
    }

private:
    static std::unique_ptr<Session> session_;
};
std::unique_ptr<Session> SessionTest::session_;

void expect_parts(const std::string& text, std::initializer_list<const char*> parts) {
    for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << '"' << part << "\" in: " << text;
}

TEST_F(SessionTest, TellsWhatItRunsOn) {
    const SessionInfo& info = session().info();
    EXPECT_EQ(info.backend, "osmesa");
    EXPECT_TRUE(info.software);
    EXPECT_EQ(info.threads, 2);
    EXPECT_GE(info.max_texture_size, 8192);
    expect_parts(info.gl_version, {"4.5"});
    EXPECT_GE(std::string(version()).size(), 5u);
    EXPECT_FALSE(std::string(revision()).empty());
}

TEST_F(SessionTest, LayersHaveTheRegionsSizeAndTheShadow) {
    RenderRequest request = make_request();
    FrameResult frame;
    const auto layers = render_layers(request, &frame);
    ASSERT_EQ(layers.size(), 1u);
    const Image& visibility = layers[0].channels.at("visibility");
    EXPECT_EQ(visibility.width, 160);
    EXPECT_EQ(visibility.height, 90);
    EXPECT_EQ(visibility.data.size(), 160u * 90);
    int lit = 0, dark = 0;
    for (std::size_t i = 0; i < visibility.data.size(); ++i) {
        lit += visibility.data[i] == 1;
        dark += visibility.data[i] == 0;
        if (frame.coverage.data[i] == 0) {
            EXPECT_EQ(visibility.data[i], 1);
        }
    }
    EXPECT_EQ(lit + dark, 160 * 90);
    EXPECT_GT(dark, 300);
    EXPECT_GT(lit, 8000);
    EXPECT_EQ(layers[0].parameters.get_int("map_size"), 1024);
    EXPECT_GT(layers[0].stats.total_ms, 0);
    EXPECT_GT(frame.stats.counters.at("triangles"), 4000);
    std::vector<std::string> stages;
    for (const StageTime& time : frame.stats.times) stages.push_back(time.stage);
    EXPECT_NE(std::find(stages.begin(), stages.end(), "frame_ids"), stages.end());
    EXPECT_NE(std::find(stages.begin(), stages.end(), "frame_resolve"), stages.end());
}

TEST_F(SessionTest, RegionsAreCutFromTheSamePicture) {
    RenderRequest request = make_request();
    const auto whole = render_layers(request);
    request.region = {70, 20, 50, 40};
    FrameResult frame;
    const auto part = render_layers(request, &frame);
    EXPECT_EQ(frame.coverage.width, 50);
    int differing = 0;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 50; ++x)
            differing += part[0].channels.at("visibility").data[std::size_t(y * 50 + x)] !=
                         whole[0].channels.at("visibility").data[std::size_t((y + 20) * 160 + x + 70)];
    EXPECT_LE(differing, 2000 / 100);  // the map is fitted anew to what is seen
}

TEST_F(SessionTest, TwoRendersAreBitIdentical) {
    RenderRequest request = make_request();
    request.samples = 5;
    request.jobs = {{0, "sm", {}}, {0, "pcf", {}}, {0, "edsm", {}}};
    FrameResult frames[2];
    const auto first = render_layers(request, &frames[0]), second = render_layers(request, &frames[1]);
    for (std::size_t i = 0; i < first.size(); ++i)
        for (const auto& [channel, image] : first[i].channels)
            EXPECT_EQ(image.data, second[i].channels.at(channel).data);
    EXPECT_EQ(frames[0].coverage.data, frames[1].coverage.data);
    EXPECT_EQ(frames[0].combined.data, frames[1].combined.data);
    // So does another session, whose caches are cold.
    Session other(test::make_session_options());
    std::size_t i = 0;
    other.render(request, [&](Layer&& layer) {
        EXPECT_EQ(layer.channels.at("visibility").data, first[i++].channels.at("visibility").data);
    });
}

TEST_F(SessionTest, LayersComeInJobOrderWhileTheRenderRuns) {
    RenderRequest request = make_request();
    auto scene = test::make_ball_scene();
    for (int i = 0; i < 5; ++i) scene->lights.push_back(scene->lights[0]);
    request.scene = scene;
    request.jobs.clear();
    for (std::uint32_t light : {3u, 0u, 3u, 5u, 1u}) request.jobs.push_back({light, "sm", {}});
    for (int samples : {1, 3}) {
        request.samples = samples;
        std::vector<std::uint32_t> order;
        std::vector<double> fractions;
        const auto caller = std::this_thread::get_id();
        session().render(
            request,
            [&](Layer&& layer) {
                EXPECT_EQ(std::this_thread::get_id(), caller);
                order.push_back(layer.job);
            },
            [&](double fraction, const std::string& text) {
                EXPECT_EQ(std::this_thread::get_id(), caller);
                EXPECT_FALSE(text.empty());
                fractions.push_back(fraction);
            });
        EXPECT_EQ(order, (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
        EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
        EXPECT_LE(fractions.back(), 1.0);
    }
}

/// The mean over box-filtered samples is the covered area of the pixel.
TEST_F(SessionTest, SamplesGiveTheCoveredArea) {
    RenderRequest request = make_request(8, 8);
    auto scene = std::make_shared<Scene>();
    scene->meshes = {
        test::to_mesh("half", {{{-9, -9, 0}, {0.3f, -9, 0}, {0.3f, 9, 0}, {-9, 9, 0}}, {{0, 1, 2}, {0, 2, 3}}})};
    scene->instances = {Instance{}};
    request.scene = scene;
    request.jobs.clear();
    request.camera = test::make_camera({0, 0, 5}, {0, 0, 0}, 1, 8, 8);
    request.camera.perspective = false;
    request.camera.window = {-4, 4, -4, 4};
    request.filter = {PixelFilterKind::Box, 1.0};
    request.samples = 64;
    const FrameResult frame = session().render(request, {});
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            EXPECT_NEAR(frame.coverage.data[std::size_t(y * 8 + x)], x < 4 ? 1 : x > 4 ? 0 : 0.3, 1.0 / 64);
    EXPECT_TRUE(frame.combined.data.size() == 8 * 8 * 4 && frame.combined.data[3] == 1);
}

TEST_F(SessionTest, AuxiliaryOutputsAreOfTheFirstSample) {
    RenderRequest request = make_request();
    request.aux = {"position", "normal", "ids", "depth"};
    const FrameResult frame = session().render(request, {});
    const glm::dvec3 forward(-glm::dvec3(request.camera.world_from_camera[2]));
    int floor_pixels = 0;
    for (std::size_t i = 0; i < 160 * 90; ++i) {
        const std::int64_t instance = frame.ids.data[2 * i];
        const float depth = frame.aux.at("depth").data[i];
        if (frame.coverage.data[i] == 0) {
            EXPECT_EQ(instance, -1);
            EXPECT_EQ(depth, 0);
            continue;
        }
        const float* p = &frame.aux.at("position").data[3 * i];
        EXPECT_NEAR(depth, glm::dot(glm::dvec3(p[0], p[1], p[2]), forward), 1e-4);
        if (instance != 0) continue;
        ++floor_pixels;
        EXPECT_NEAR(p[2] + frame.camera_position.z, 0, 1e-5);
        EXPECT_EQ(frame.aux.at("normal").data[3 * i + 2], 1);
    }
    EXPECT_GT(floor_pixels, 5000);
}

TEST_F(SessionTest, LightWithoutShadowsIsOneOnFacesTurnedToIt) {
    RenderRequest request = make_request();
    auto scene = test::make_ball_scene();
    scene->lights[0].casts_shadow = false;
    request.scene = scene;
    request.aux = {"position", "normal"};
    FrameResult frame;
    const auto layers = render_layers(request, &frame);
    const glm::vec3 light_rel(glm::dvec3(scene->lights[0].world_from_light[3]) - frame.camera_position);
    int turned_away = 0;
    for (std::size_t i = 0; i < 160 * 90; ++i) {
        const float* p = &frame.aux["position"].data[3 * i];
        const float* n = &frame.aux["normal"].data[3 * i];
        const float facing = glm::dot(light_rel - glm::vec3(p[0], p[1], p[2]), glm::vec3(n[0], n[1], n[2]));
        const bool away = frame.coverage.data[i] > 0 && facing <= 0;
        turned_away += away;
        EXPECT_EQ(layers[0].channels.at("visibility").data[i], away ? 0 : 1);
    }
    EXPECT_GT(turned_away, 50);
}

TEST_F(SessionTest, EmptyScenesAndNoLightsGiveAPicture) {
    RenderRequest request = make_request(32, 16);
    auto scene = std::make_shared<Scene>();
    request.scene = scene;
    request.jobs.clear();
    FrameResult frame = session().render(request, {});
    EXPECT_EQ(*std::max_element(frame.coverage.data.begin(), frame.coverage.data.end()), 0);
    scene->lights.resize(1);
    request.jobs = {{0, "sm", {}}};
    const auto layers = render_layers(request);
    for (float value : layers.at(0).channels.at("visibility").data) EXPECT_EQ(value, 1);
}

TEST_F(SessionTest, BadRequestsAreNamed) {
    RenderRequest request = make_request();
    const auto with = [&](auto change) {
        RenderRequest changed = request;
        change(changed);
        return message_of(changed);
    };
    expect_parts(with([](auto& r) { r.scene = nullptr; }), {"scene"});
    expect_parts(with([](auto& r) { r.width = 0; }), {"0x90"});
    expect_parts(with([](auto& r) { r.samples = 65; }), {"samples", "65", "64"});
    expect_parts(with([](auto& r) { r.samples = 0; }), {"samples"});
    expect_parts(with([](auto& r) { r.filter.width_px = NAN; }), {"filter"});
    expect_parts(with([](auto& r) { r.region = {100, 0, 100, 10}; }), {"region", "160x90"});
    expect_parts(with([](auto& r) { r.region = {5, 5, 0, 0}; }), {"region"});
    expect_parts(with([](auto& r) { r.width = r.height = 1 << 20; }), {"limit", "regions"});
    expect_parts(with([](auto& r) { r.jobs[0].light = 7; }), {"light 7", "1 lights"});
    expect_parts(with([](auto& r) { r.jobs[0].technique = "raytrace"; }), {"raytrace", "sm", "edsm"});
    expect_parts(with([](auto& r) { r.jobs[0].parameters.set("kernel", true); }), {"sm", "kernel", "map_size"});
    expect_parts(with([](auto& r) { r.aux = {"albedo"}; }), {"albedo", "depth"});
    expect_parts(with([](auto& r) { r.camera.clip_end = r.camera.clip_start; }), {"clip_end"});
    EXPECT_EQ(render_layers(request).size(), 1u);
}

TEST_F(SessionTest, MapsBeyondTheDriversLimitAreNamed) {
    RenderRequest request = make_request();
    const int limit = session().info().max_texture_size;
    request.jobs[0].parameters.set("map_size", std::int64_t(limit));
    // The map alone would fit; its border does not.
    expect_parts(message_of(request), {"map_size", std::to_string(limit).c_str(), "limit"});
}

TEST_F(SessionTest, CancelFromAnotherThreadEndsTheRender) {
    const RenderRequest request = make_long_request();
    for (int delay_ms : {0, 30, 200}) {
        std::atomic<int> layers{0};
        Clock::time_point asked;
        std::thread canceller([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms + 5));
            asked = Clock::now();
            session().cancel();
        });
        EXPECT_THROW(session().render(request, [&](Layer&&) { ++layers; }), Cancelled);
        const auto waited = Clock::now();
        canceller.join();
        // The promise is 300 ms on a machine of its own; tests may share theirs.
        EXPECT_LT(std::chrono::duration<double>(waited - asked).count(), 3.0);
        EXPECT_EQ(layers, 0);
    }
    session().cancel();  // nothing runs: nothing happens
    EXPECT_EQ(render_layers(make_request()).size(), 1u);
}

TEST_F(SessionTest, WhatTheSinkThrowsReachesTheCaller) {
    RenderRequest request = make_long_request();
    request.samples = 1;
    int layers = 0;
    const auto sink = [&](Layer&&) {
        if (++layers == 3) throw std::logic_error("disk full");
    };
    EXPECT_THROW(session().render(request, sink), std::logic_error);
    EXPECT_EQ(layers, 3);
    EXPECT_THROW(session().render(request, {}, [](double, const std::string&) { throw 5; }), int);
    EXPECT_EQ(render_layers(make_request()).size(), 1u);
}

TEST_F(SessionTest, CancelFromTheSinkIsHeard) {
    RenderRequest request = make_long_request();
    request.samples = 1;
    int layers = 0;
    EXPECT_THROW(session().render(request,
                                  [&](Layer&&) {
                                      ++layers;
                                      session().cancel();
                                  }),
                 Cancelled);
    EXPECT_LT(layers, 10);
}

TEST_F(SessionTest, CallersOnSeveralThreadsTakeTurns) {
    std::vector<std::thread> callers;
    std::atomic<int> whole{0};
    for (int i = 0; i < 4; ++i)
        callers.emplace_back([&, i] {
            RenderRequest request = make_request(40 + i, 30);
            session().render(request, [&, i](Layer&& layer) { whole += layer.channels["visibility"].width == 40 + i; });
        });
    for (std::thread& caller : callers) caller.join();
    EXPECT_EQ(whole, 4);
}

TEST_F(SessionTest, NothingGrowsOverManyFrames) {
    auto scene = test::make_ball_scene();
    RenderRequest request = make_request(96, 54);
    request.jobs = {{0, "sm", {}}, {0, "edsm", {}}, {0, "sv", {}}, {0, "exact", {}}};
    for (LayerJob& job : {std::ref(request.jobs[0]), std::ref(request.jobs[1])})
        job.parameters.set("map_size", std::int64_t(128));
    // Caches of its own, small enough to be full after a few frames: what grows then can only be a leak.
    SessionOptions options = test::make_session_options();
    options.gpu_cache_bytes = std::size_t{2} << 20;
    options.host_cache_bytes = std::size_t{1} << 20;
    Session small(options);
    std::size_t host = 0, gpu = 0;
    for (int frame = 0; frame < 200; ++frame) {
        // A deforming mesh of a topology of its own, and a moving light: nothing can be used again.
        testing::MeshData ball = testing::make_sphere(1.0f, 20, 24 + frame % 10);
        for (glm::vec3& p : ball.positions) p *= 1.0f + 0.001f * float(frame);
        std::rotate(ball.triangles.begin(), ball.triangles.begin() + frame, ball.triangles.end());
        auto moved = std::make_shared<Scene>(*scene);
        moved->meshes[1] = testing::to_mesh("ball", std::move(ball));
        moved->lights[0].world_from_light[3].x += 0.01 * frame;
        request.scene = moved;
        small.render(request, {});
        if (frame <= 40) host = std::max(host, small.host_bytes()), gpu = std::max(gpu, small.gpu_bytes());
        if (frame > 40) {
            ASSERT_LE(small.gpu_bytes(), gpu + (std::size_t{256} << 10)) << frame;
            ASSERT_LE(small.host_bytes(), host + (std::size_t{64} << 10)) << frame;
        }
    }
    EXPECT_LE(gpu, std::size_t{6} << 20);
    EXPECT_LE(host, std::size_t{4} << 20);
}

/// A caster that moves within its lights' views, and one that comes into them: each frame is what a session shows that
/// has not seen the frames before.
TEST_F(SessionTest, MovingCastersLeaveNoStaleShadows) {
    const auto make_frame = [](int frame) {
        auto scene = test::make_ball_scene();
        for (const LightKind kind : {LightKind::Sun, LightKind::Spot}) {
            Light light = scene->lights[0];
            light.kind = kind;
            light.name = "another";
            scene->lights.push_back(light);
        }
        scene->instances[1].world_from_object[3] += glm::dvec4(0.03 * frame, 0.02 * frame, 0, 0);
        Instance second = scene->instances[1];
        second.world_from_object = glm::translate(glm::dmat4(1), glm::dvec3(0.7, -0.4, frame == 2 ? 2.5 : 400.0)) *
                                   glm::scale(glm::dmat4(1), glm::dvec3(0.2));
        scene->instances.push_back(second);
        return scene;
    };
    const auto render = [](Session& with, const std::shared_ptr<Scene>& scene) {
        RenderRequest request = make_request(64, 36);
        request.scene = scene;
        request.samples = 4;
        request.jobs.clear();
        for (std::uint32_t light = 0; light < 3; ++light)
            for (const char* technique : {"sm", "edsm", "vsm", "exact", "sv"})
                request.jobs.push_back({light, technique, {}});
        std::vector<std::vector<float>> pictures;
        with.render(request, [&](Layer&& layer) { pictures.push_back(layer.channels.at("visibility").data); });
        return pictures;
    };
    Session own(test::make_session_options());
    std::vector<std::vector<float>> before;
    for (int frame = 0; frame < 4; ++frame) {
        Session fresh(test::make_session_options());
        const auto pictures = render(own, make_frame(frame));
        EXPECT_EQ(pictures, render(fresh, make_frame(frame))) << frame;
        EXPECT_NE(pictures, before) << frame;
        before = pictures;
    }
}

TEST_F(SessionTest, HostBytesAreOfTheHostAndCountMeshData) {
    Session own(test::make_session_options());
    RenderRequest request = make_request(32, 18);
    auto scene = std::make_shared<Scene>(*request.scene);
    scene->meshes[1] = testing::to_mesh("fine ball", testing::make_sphere(1.0f, 200, 300));
    request.scene = scene;
    request.jobs[0].parameters.set("map_size", std::int64_t(2048));
    own.render(request, {});
    EXPECT_GT(own.gpu_bytes(), std::size_t{4 * 2048 * 2048});
    EXPECT_LT(own.host_bytes(), std::size_t{4 << 20});  // a map lies on the GL
    const std::size_t before = own.host_bytes();
    request.jobs = {{0, "sv", {}}};
    own.render(request, {});
    // Each triangle has three halves of edges: their ends, their triangles, and each triangle's part.
    const std::size_t triangles = scene->meshes[1]->triangles.size();
    EXPECT_GT(own.host_bytes() - before, triangles * (3 * 8 / 2 + 3 * 4 + 4));
    EXPECT_LT(own.host_bytes() - before, triangles * 40);
}

TEST_F(SessionTest, TopologiesThatWentByAreFreed) {
    Session own(test::make_session_options());
    RenderRequest request = make_request(32, 18);
    request.jobs = {{0, "sv", {}}};
    const auto allocated = [] {
        const struct mallinfo2 info = mallinfo2();
        return info.uordblks + info.hblkhd;
    };
    if (allocated() == 0) GTEST_SKIP() << "this allocator does not tell";
    std::size_t early = 0;
    for (int frame = 0; frame < 24; ++frame) {
        auto scene = std::make_shared<Scene>(*request.scene);
        testing::MeshData ball = testing::make_sphere(1.0f, 150, 200);
        std::rotate(ball.triangles.begin(), ball.triangles.begin() + frame, ball.triangles.end());
        scene->meshes[1] = testing::to_mesh("ball", std::move(ball));
        request.scene = scene;
        own.render(request, {});
        if (frame == 10) early = allocated();
    }
    // One frame's adjacency takes more than that.
    EXPECT_LT(double(allocated()) - double(early), 1e6);
}

TEST(SessionLife, OpensAndClosesManyTimes) {
    for (int i = 0; i < 4; ++i) {
        Session session(test::make_session_options());
        RenderRequest request = test::make_request(test::make_ball_scene(), 32, 18);
        request.jobs = {{0, "sm", {}}};
        int layers = 0;
        session.render(request, [&](Layer&&) { ++layers; });
        EXPECT_EQ(layers, 1);
        session.close();
        session.close();
        EXPECT_THROW(session.render(request, {}), InputError);
    }
}

TEST(SessionLife, ClosingEndsARunningRender) {
    for (bool destroy : {false, true}) {
        auto session = std::make_unique<Session>(test::make_session_options());
        RenderRequest request = test::make_request(test::make_ball_scene(), 640, 360);
        request.samples = 64;
        for (int i = 0; i < 60; ++i) request.jobs.push_back({0, "pcf", {}});
        std::atomic<bool> cancelled{false}, started{false};
        Session* raw = session.get();
        std::thread caller([&] {
            try {
                raw->render(request, {}, [&](double, const std::string&) { started = true; });
            } catch (const Cancelled&) {
                cancelled = true;
            }
        });
        while (!started) std::this_thread::yield();
        if (destroy)
            session.reset();
        else
            session->close();
        caller.join();
        EXPECT_TRUE(cancelled);
    }
}

TEST(SessionLife, BadOptionsAreNamed) {
    SessionOptions options = test::make_session_options();
    options.backend = "vulkan";
    EXPECT_THROW(Session{options}, InputError);
    options = test::make_session_options();
    options.shader_dir = "/nowhere/shaders";
    try {
        Session session(options);
        FAIL();
    } catch (const ShaderError& error) {
        expect_parts(error.what(), {"/nowhere/shaders", "reinstall"});
    }
}

}  // namespace
}  // namespace shadow_layers
