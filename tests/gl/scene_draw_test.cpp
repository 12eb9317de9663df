// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Drawing instances under any matrix, and the meshes kept on the GPU: engine/.
#include "engine/scene_draw.h"

#include "gl_fixture.h"

namespace shadow_layers {
namespace {

class SceneDrawTest : public test::EngineTest {
protected:
    static constexpr int kSize = 64;
    /// Instance and triangle of every pixel.
    std::vector<glm::uvec2> draw(const Scene& scene, const std::vector<std::uint32_t>& instances,
                                 const glm::dmat4& clip_from_ws = glm::dmat4(1.0)) {
        auto ids_tx = std::make_shared<gl::Texture>(engine().device(), gl::TextureDesc{GL_RG32UI, kSize, kSize}, "ids");
        auto depth_tx = std::make_shared<gl::Texture>(engine().device(),
                                                      gl::TextureDesc{GL_DEPTH_COMPONENT32F, kSize, kSize}, "depth");
        gl::Framebuffer framebuffer(engine().device(), "ids");
        framebuffer.attach_color(0, ids_tx);
        framebuffer.attach_depth(depth_tx);
        framebuffer.bind();
        framebuffer.clear_color_uint(0, kNothing, kNothing);
        framebuffer.clear_depth();
        const gl::Program& program = engine().program("frame/visibility.vert", "frame/visibility.frag");
        draw_scene(engine(), program, DrawState::nearest(), {scene, instances, clip_from_ws, true});
        return ids_tx->download<glm::uvec2>();
    }
    static constexpr std::uint32_t kNothing = 0xffffffffu;
};

/// A strip of cells along x over [-1, 1], two triangles each.
test::MeshData make_strip(int cells) {
    test::MeshData strip;
    for (int i = 0; i <= cells; ++i)
        for (float y : {-1.0f, 1.0f}) strip.positions.emplace_back(2.0f * float(i) / float(cells) - 1, y, 0.5f);
    for (std::uint32_t i = 0; i < std::uint32_t(cells); ++i) {
        strip.triangles.emplace_back(2 * i, 2 * i + 2, 2 * i + 3);
        strip.triangles.emplace_back(2 * i, 2 * i + 3, 2 * i + 1);
    }
    return strip;
}

TEST_F(SceneDrawTest, TrianglesKeepTheirNumbersOverPieces) {
    Scene scene;
    // More than two pieces of triangles, of which only the cells at pixel centres are seen.
    constexpr int kCells = 300'000;
    scene.meshes = {test::to_mesh("strip", make_strip(kCells))};
    scene.instances = {Instance{}};
    const auto ids = draw(scene, {0});
    for (int x = 0; x < kSize; ++x) {
        const double cell = (x + 0.5) / kSize * kCells;
        EXPECT_NEAR(double(ids[10 * kSize + x].y / 2), cell, 0.01 * kCells / kSize) << x;
    }
}

TEST_F(SceneDrawTest, InstancesOfManyMeshesKeepTheirNumbers) {
    Scene scene;
    scene.meshes = {test::to_mesh("a", test::make_quad(1)), test::to_mesh("b", test::make_ball(8, 16))};
    std::vector<std::uint32_t> all;
    for (int i = 0; i < kSize; ++i) {
        Instance instance;
        instance.mesh = std::uint32_t(i * 7 % 2);
        const double x = (i + 0.5) / kSize * 2 - 1;
        instance.world_from_object =
            glm::scale(glm::translate(glm::dmat4(1.0), {x, 0, 0.5}), glm::dvec3(0.9 / kSize, 0.9, 0.1));
        scene.instances.push_back(instance);
        all.push_back(std::uint32_t(kSize - 1 - i));
    }
    const auto ids = draw(scene, all);
    for (int x = 0; x < kSize; ++x) EXPECT_EQ(ids[std::size_t(kSize / 2 * kSize + x)].x, std::uint32_t(x));
    const auto some = draw(scene, {3, 10});
    EXPECT_EQ(some[std::size_t(kSize / 2 * kSize + 10)].x, 10u);
    EXPECT_EQ(some[std::size_t(kSize / 2 * kSize + 11)].x, kNothing);
}

TEST_F(SceneDrawTest, OffsetsCancelInDouble) {
    Scene scene;
    scene.meshes = {test::to_mesh("quad", test::make_quad(0.5))};
    Instance instance;
    const glm::dvec3 far_away(1e9, -3e9, 2e9);
    instance.world_from_object = glm::translate(glm::dmat4(1.0), far_away);
    scene.instances = {instance};
    glm::dmat4 clip = glm::translate(glm::dmat4(1.0), -far_away + glm::dvec3(0, 0, 0.5));
    const auto ids = draw(scene, {0}, clip);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const bool inside = x >= 16 && x < 48 && y >= 16 && y < 48;
            EXPECT_EQ(ids[std::size_t(y * kSize + x)].x, inside ? 0u : kNothing);
        }
}

TEST_F(SceneDrawTest, MeshesAreUploadedOnceByContent) {
    Scene scene;
    scene.meshes = {test::to_mesh("a", test::make_quad(1)), test::to_mesh("copy of a", test::make_quad(1)),
                    test::to_mesh("b", test::make_ball(8, 16))};
    scene.instances.resize(3);
    for (std::uint32_t i = 0; i < 3; ++i) scene.instances[i].mesh = i;
    for (int i = 0; i < 3; ++i) draw(scene, {0, 1, 2});
    EXPECT_EQ(engine().meshes().upload_count(), 2u);
    const auto gpu = engine().meshes().get(engine(), *scene.meshes[0]);
    EXPECT_EQ(gpu->triangle_count, 2u);
    EXPECT_EQ(engine().meshes().bytes(),
              gpu->byte_size() + engine().meshes().get(engine(), *scene.meshes[2])->byte_size());
}

TEST_F(SceneDrawTest, LeastRecentlyUsedMeshesLeaveFirst) {
    const auto mesh = [](float size) { return test::to_mesh("quad", test::make_quad(size)); };
    const std::size_t quad_bytes = 4 * 12 + 2 * 2 * 12;
    MeshCache cache(3 * quad_bytes);
    const auto a = mesh(1), b = mesh(2), c = mesh(3), d = mesh(4);
    for (const auto& m : {a, b, c, a, d}) cache.get(engine(), *m);  // b leaves
    EXPECT_EQ(cache.upload_count(), 4u);
    EXPECT_LE(cache.bytes(), 3 * quad_bytes);
    for (const auto& m : {a, c, d}) cache.get(engine(), *m);
    EXPECT_EQ(cache.upload_count(), 4u);
    cache.get(engine(), *b);
    EXPECT_EQ(cache.upload_count(), 5u);
}

TEST_F(SceneDrawTest, CancelIsHeardBetweenPieces) {
    Scene scene;
    scene.meshes = {test::to_mesh("strip", make_strip(200'000))};
    scene.instances = {Instance{}};
    engine().cancel_token().request();
    EXPECT_THROW(draw(scene, {0}), Cancelled);
    engine().cancel_token().reset();
    EXPECT_NO_THROW(draw(scene, {0}));
}

}  // namespace
}  // namespace shadow_layers
