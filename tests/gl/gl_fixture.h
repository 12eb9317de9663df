// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by the tests that need a GL: an engine and a session on OSMesa, and small scenes.
#pragma once

#include <gtest/gtest.h>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <string>
#include <vector>

#include "context/context.h"
#include "engine/engine.h"
#include "gl/shared_session.h"
#include "shadow_layers/session.h"

namespace shadow_layers::test {

inline EngineOptions engine_options() {
    EngineOptions options;
    options.shader_dir = SHADOW_LAYERS_SHADER_DIR;
    options.threads = 2;
    options.debug = true;
    return options;
}

using testing::make_session_options;

/// A context and an engine on the test's own thread; GL errors and leaked objects fail the test.
class EngineTest : public ::testing::Test {
protected:
    void SetUp() override {
        context_ = make_context("osmesa", 2);
        engine_ = std::make_unique<Engine>(*context_, engine_options());
    }
    void TearDown() override {
        EXPECT_NO_THROW(engine_->check_gl("the end of the test"));
        engine_.reset();
        context_.reset();
    }
    Engine& engine() { return *engine_; }

private:
    std::unique_ptr<Context> context_;
    std::unique_ptr<Engine> engine_;
};

struct MeshData {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
};

inline std::shared_ptr<const Mesh> to_mesh(const std::string& name, MeshData data) {
    auto owner = std::make_shared<MeshData>(std::move(data));
    return make_mesh(name, owner->positions, owner->triangles, owner);
}

/// A square of side 2 * `half` in the plane z = 0.
inline MeshData make_quad(float half = 1) {
    return {{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

/// A ball of radius 1 with vertices on it.
inline MeshData make_ball(int rings = 32, int segments = 64) {
    MeshData ball;
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const double theta = M_PI * r / rings, phi = 2 * M_PI * s / segments;
            ball.positions.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                        std::cos(theta));
        }
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const auto at = [&](int ring, int segment) { return std::uint32_t(ring * segments + segment % segments); };
            ball.triangles.emplace_back(at(r, s), at(r + 1, s), at(r + 1, s + 1));
            ball.triangles.emplace_back(at(r, s), at(r + 1, s + 1), at(r, s + 1));
        }
    return ball;
}

/// Camera at `eye` that looks at `target`; `fov` is the full horizontal angle in radians.
inline Camera make_camera(const glm::dvec3& eye, const glm::dvec3& target, double fov, int width, int height,
                          double clip_start = 0.1, double clip_end = 1000) {
    Camera camera;
    const double half = std::tan(0.5 * fov), aspect = double(height) / width;
    camera.window = {-half, half, -half * aspect, half * aspect};
    camera.clip_start = clip_start;
    camera.clip_end = clip_end;
    const glm::dvec3 back = glm::normalize(eye - target);
    const glm::dvec3 up = std::abs(back.z) > 0.99 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 right = glm::normalize(glm::cross(up, back));
    camera.world_from_camera = glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0),
                                          glm::dvec4(back, 0), glm::dvec4(eye, 1));
    return camera;
}

/// A ball of radius 1 at height 1 on a floor of side 20, and a point light above.
inline std::shared_ptr<Scene> make_ball_scene() {
    auto scene = std::make_shared<Scene>();
    scene->meshes = {to_mesh("floor", make_quad(10)), to_mesh("ball", make_ball())};
    Instance floor, ball;
    ball.mesh = 1;
    ball.world_from_object = glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 1));
    scene->instances = {floor, ball};
    Light light;
    light.name = "lamp";
    light.energy = 1000;
    light.world_from_light = glm::translate(glm::dmat4(1.0), glm::dvec3(2, -1, 5));
    scene->lights = {light};
    return scene;
}

inline RenderRequest make_request(std::shared_ptr<const Scene> scene, int width = 160, int height = 90) {
    RenderRequest request;
    request.scene = std::move(scene);
    request.width = width;
    request.height = height;
    request.camera = make_camera({6, -7, 5}, {0, 0, 0.7}, 0.9, width, height);
    return request;
}

}  // namespace shadow_layers::test
