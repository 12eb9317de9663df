// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "context/context.h"

#include <gtest/gtest.h>

#include <thread>

#include "gl_fixture.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

TEST(Context, OSMesaGivesGL45) {
    const auto context = make_context("osmesa", 2);
    EXPECT_EQ(context->description(), "osmesa");
    EXPECT_TRUE(context->software());
    EXPECT_NE(context->load("glClipControl"), nullptr);
    const auto load = [](void* user, const char* name) { return static_cast<Context*>(user)->load(name); };
    const gl::Device device(load, context.get(), false);
    EXPECT_TRUE(device.gl().VERSION_4_5);
    EXPECT_TRUE(device.software());
    EXPECT_GE(device.limits().max_texture_size, 8192);
}

TEST(Context, UnknownBackEndIsNamedWithTheKnownOnes) {
    try {
        make_context("directx", 0);
        FAIL();
    } catch (const InputError& error) {
        const std::string text = error.what();
        for (const char* part : {"directx", "auto", "osmesa", "egl"}) EXPECT_NE(text.find(part), std::string::npos);
    }
}

TEST(Context, AutoAlwaysFindsOneHere) { EXPECT_FALSE(make_context("auto", 2)->description().empty()); }

/// Where EGL works at all (a GPU, or Mesa without one), a session on it must give the pictures that OSMesa gives.
TEST(Context, EGLDrawsWhatOSMesaDraws) {
    SessionOptions options = test::make_session_options();
    options.backend = "egl";
    std::unique_ptr<Session> egl;
    try {
        egl = std::make_unique<Session>(options);
    } catch (const ContextError& error) {
        EXPECT_NE(std::string(error.what()).find("libegl1"), std::string::npos);
        GTEST_SKIP() << error.what();
    }
    Session osmesa(test::make_session_options());
    RenderRequest request = test::make_request(test::make_ball_scene());
    request.jobs = {{0, "sm", {}}};
    std::vector<float> pictures[2];
    int differing = 0;
    egl->render(request, [&](Layer&& layer) { pictures[0] = layer.channels["visibility"].data; });
    osmesa.render(request, [&](Layer&& layer) { pictures[1] = layer.channels["visibility"].data; });
    ASSERT_EQ(pictures[0].size(), pictures[1].size());
    for (std::size_t i = 0; i < pictures[0].size(); ++i) differing += pictures[0][i] != pictures[1][i];
    // Another driver rounds otherwise at the borders; the same one must agree everywhere.
    EXPECT_LE(differing, egl->info().gl_renderer == osmesa.info().gl_renderer ? 0 : int(pictures[0].size() / 500));
}

TEST(Context, TwoThreadsOwnOneEach) {
    const auto work = [] {
        for (int i = 0; i < 3; ++i) {
            const auto context = make_context("osmesa", 2);
            Engine engine(*context, test::engine_options());
            gl::Texture texture(engine.device(), {GL_R32F, 16, 16}, "thread");
            const float value = 0.25f;
            texture.clear(&value);
            EXPECT_EQ(texture.download<float>()[100], value);
        }
    };
    std::thread first(work), second(work);
    first.join();
    second.join();
}

}  // namespace
}  // namespace shadow_layers
