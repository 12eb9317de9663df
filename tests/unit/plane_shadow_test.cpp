// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow areas in pixels against closed forms and against many rays, and places in pixels against both.
#include "truth/plane_shadow.h"

#include <gtest/gtest.h>

#include <numeric>

#include "lights/facing.h"
#include "lights/light_shape.h"
#include "support/half_plane_scene.h"
#include "support/soup_scene.h"
#include "truth/pixel_samples.h"

namespace shadow_layers::testing {
namespace {

using truth::PixelSamples;
using truth::PlaneShadows;
using truth::SampleReceiver;

/// All that pixels are asked of, for a scene with one light.
struct PixelView {
    PixelView(std::shared_ptr<Scene> scene_, const Camera& camera, int width, int height)
        : scene(std::move(scene_)),
          position(sample_light_shape(scene->lights[0], 1).front()),
          oracle(scene),
          tree(oracle, *scene),
          frame(oracle.make_frame(camera, width, height)),
          planes(oracle, tree, frame, scene->lights[0], position),
          samples(oracle, frame, scene->lights[0], position) {}
    explicit PixelView(const SceneView& view) : PixelView(view.scene, view.camera, view.width, view.height) {}

    double take_mean(std::size_t pixel, const std::vector<glm::dvec2>& offsets, SampleReceiver receiver) const {
        const auto visible = samples.find_visibility(pixel, offsets, receiver);
        return std::accumulate(visible.begin(), visible.end(), 0.0) / double(visible.size());
    }
    /// Whether rays through a grid of the square all see triangles in the plane of the centre's.
    bool rays_see_plane_alone(std::size_t pixel, int across) const {
        const glm::dvec3 normal(frame.normals[pixel]);
        for (int k = 0; k < across * across; ++k) {
            const double x = (k % across + 0.5) / across, y = (k / across + 0.5) / across;
            const auto ray =
                truth::compute_pixel_ray(frame.camera, double(pixel % std::size_t(frame.width)) + x,
                                         double(pixel / std::size_t(frame.width)) + y, frame.width, frame.height);
            const auto hit = oracle.find_first(ray.origin_ws, ray.direction, frame.camera.clip_start,
                                               frame.camera.clip_end, kInstanceCamera);
            if (!hit) return false;
            for (const glm::dvec3& corner : oracle.get_corners(hit->ids)) {
                const glm::dvec3 way =
                    corner + oracle.get_origin() - frame.origin_ws - glm::dvec3(frame.positions_rel[pixel]);
                if (std::abs(glm::dot(way, normal)) > 1e-5 * glm::length(way)) return false;
            }
        }
        return true;
    }

    std::shared_ptr<Scene> scene;
    LightSample position;
    truth::RayOracle oracle;
    truth::TriangleTree tree;
    Frame frame;
    PlaneShadows planes;
    PixelSamples samples;
};

std::vector<glm::dvec2> make_grid(int across) {
    std::vector<glm::dvec2> offsets;
    for (int k = 0; k < across * across; ++k)
        offsets.push_back((glm::dvec2(k % across, k / across) + 0.5) / double(across) - 0.5);
    return offsets;
}

TEST(PlaneShadows, HalfPlanesInClosedForm) {
    for (const double angle : {0.01, 0.05, 0.4, 0.9, 2.2, 3.9}) {
        HalfPlaneScene half;
        half.turn_camera(angle, 0.0123);
        const PixelView view(half.scene, half.camera, HalfPlaneScene::kWidth, HalfPlaneScene::kHeight);
        for (std::size_t pixel = 0; pixel < view.frame.pixel_count(); ++pixel) {
            EXPECT_TRUE(view.planes.sees_plane_alone(pixel));
            EXPECT_NEAR(view.planes.find_lit_part(pixel).value(), half.find_part_beyond(pixel, 0), 1e-10);
        }
    }
}

// A bar's shadow much thinner than a pixel: two half planes, between which rays through a grid may find nothing.
TEST(PlaneShadows, ThinBarsInClosedForm) {
    for (const float width : {1e-5f, 1e-3f, 0.02f}) {
        HalfPlaneScene half;
        half.turn_camera(0.7, 0);
        MeshData bar = make_plane(1);
        for (glm::vec3& p : bar.positions) p *= glm::vec3(width, 10, 1);
        half.scene->meshes[1] = to_mesh("bar", bar);
        half.scene->instances[1].world_from_object[3] = glm::dvec4(0.0301, 0, 1, 1);
        const PixelView view(half.scene, half.camera, HalfPlaneScene::kWidth, HalfPlaneScene::kHeight);
        const double edge = 0.5 * double(width);
        for (std::size_t pixel = 0; pixel < view.frame.pixel_count(); ++pixel) {
            const double dark =
                half.find_part_beyond(pixel, 0.0301 - edge) - half.find_part_beyond(pixel, 0.0301 + edge);
            EXPECT_NEAR(view.planes.find_lit_part(pixel).value(), 1 - dark, 1e-10);
        }
    }
}

/// Compares areas with rays through a fine grid, for the pixels whose plane is decided by casters.
void compare_with_rays(const PixelView& view, int stride, int least_border) {
    const auto grid = make_grid(48);
    int border = 0;
    double sum = 0;
    for (std::size_t pixel = 0; pixel < view.frame.pixel_count(); pixel += std::size_t(stride)) {
        const auto part = view.planes.find_lit_part(pixel);
        if (!part) continue;
        const double mean = view.take_mean(pixel, grid, SampleReceiver::CentreFacet);
        ASSERT_NEAR(*part, mean, 0.035) << "pixel " << pixel;
        if (mean <= 0 || mean >= 1) continue;
        sum += *part - mean;
        ++border;
    }
    EXPECT_GE(border, least_border);
    EXPECT_LT(std::abs(sum / std::max(border, 1)), 0.002);
}

TEST(PlaneShadows, SoupsAreWhatManyRaysSay) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SceneView view = make_soup_scene(seed, 80, 45);
        view.scene->lights = {make_light(LightKind(seed % 4), {1.5, 1.0, 5.0}, {0, 0, 0.5}, 90)};
        compare_with_rays(PixelView(view), 3, 50);
    }
}

// Triangles that reach behind the light, to its plane and through the receiver's.
TEST(PlaneShadows, LightAmongTheCasters) {
    for (const glm::dvec3& place : {glm::dvec3(0.1, 0.2, 0.9), {0.4, -0.3, 0.25}, {-0.8, 0.5, 1.4}}) {
        SceneView view = make_soup_scene(9, 64, 36);
        view.scene->lights = {make_light(LightKind::Point, place, {0.3, 0.3, -2})};
        compare_with_rays(PixelView(view), 3, 20);
    }
}

TEST(PlaneShadows, ParallelViewAndScenesFarFromTheOrigin) {
    for (const double scale : {1e-3, 1e4}) {
        SceneView view = random_scene(5, 80, 45);
        const glm::dmat4 move =
            glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(3e5, -7e5, 2e5) * scale), glm::dvec3(scale));
        for (Instance& instance : view.scene->instances) instance.world_from_object = move * instance.world_from_object;
        const auto at = [&](glm::dvec3 p) { return glm::dvec3(move * glm::dvec4(p, 1)); };
        view.camera = make_camera(at({3.6, -3.9, 3.6}), at({0, 0, 0.6}), view.width, view.height);
        view.camera.perspective = false;
        for (double* side :
             {&view.camera.window.left, &view.camera.window.right, &view.camera.window.bottom, &view.camera.window.top})
            *side *= 6 * scale;
        view.camera.clip_start *= scale, view.camera.clip_end *= scale;
        view.scene->lights = {make_light(LightKind::Spot, at({2, 1.5, 4}), at({0, 0, 0}), 90)};
        compare_with_rays(PixelView(view), 3, 20);
    }
}

// Walls stand on the floor and run through it: what is below casts nothing on it.
TEST(PlaneShadows, CastersThroughThePlane) {
    SceneView view;
    view.width = 80, view.height = 45;
    view.place(view.add("floor", make_plane(8, 3)));
    view.place(view.add("box", make_box({1, 1, 1})), placement({0, 0, 0.2}, 23, {0.3, 0.2, 1}));
    view.camera = make_camera({3, -3, 3}, {0, 0, 0}, view.width, view.height);
    view.scene->lights = {make_light(LightKind::Sun, {2, 1.5, 2}, {0, 0, 0})};
    compare_with_rays(PixelView(view), 1, 30);
}

TEST(PlaneShadows, OnePlaneIsWhereRaysSeeNothingElse) {
    int alone = 0, others = 0, missed = 0;
    for (unsigned seed = 1; seed <= 3; ++seed) {
        SceneView view = seed == 3 ? make_soup_scene(seed, 80, 45) : random_scene(seed, 80, 45);
        view.scene->lights = {make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0.5}, 120)};
        const PixelView pixels(view);
        const FacingRule rule(pixels.frame, view.scene->lights[0], pixels.position);
        for (std::size_t pixel = 0; pixel < pixels.frame.pixel_count(); ++pixel) {
            const bool claimed = pixels.planes.sees_plane_alone(pixel);
            if (rule.classify(pixel) != Facing::Undecided) {
                EXPECT_FALSE(claimed);
                continue;
            }
            const bool seen = pixels.rays_see_plane_alone(pixel, 12);
            EXPECT_TRUE(!claimed || seen) << pixel;
            missed += seen && !claimed && pixels.rays_see_plane_alone(pixel, 96);
            ++(claimed ? alone : others);
        }
    }
    EXPECT_GT(alone, 2000);
    EXPECT_GT(others, 400);
    EXPECT_LT(missed, 20) << "tips between the rays, eight times as many where it matters";
}

TEST(PlaneShadows, NothingIsToldAtTheRimOfACone) {
    SceneView view;
    view.width = 64, view.height = 36;
    view.place(view.add("floor", make_plane(20)));
    view.camera = make_camera({0, 0, 5}, {0, 0, 0}, view.width, view.height);
    view.scene->lights = {make_light(LightKind::Spot, {0, 0, 3}, {0, 0, 0}, 40)};
    const PixelView pixels(view);
    int rim = 0;
    for (std::size_t pixel = 0; pixel < pixels.frame.pixel_count(); ++pixel) {
        const glm::dvec3 place = pixels.frame.origin_ws + glm::dvec3(pixels.frame.positions_rel[pixel]);
        const double beyond = glm::length(glm::dvec2(place)) / (3 * std::tan(glm::radians(20.0)));
        const auto part = pixels.planes.find_lit_part(pixel);
        if (beyond < 0.9) {
            EXPECT_EQ(part, 1.0);
        } else if (beyond > 1.1) {
            EXPECT_EQ(part, std::nullopt);
        }
        rim += !part && beyond < 1;
    }
    EXPECT_GT(rim, 10);
}

TEST(PixelSamples, PlacesByTheirOwnRaysAndOnTheFacetAgreeOnAPlane) {
    SceneView view = random_scene(7, 96, 54);
    view.scene->lights = {make_light(LightKind::Spot, {2, 1.5, 4}, {0, 0, 0.5}, 40)};
    const PixelView pixels(view);
    const auto offsets = truth::make_jittered_offsets(5, 3);
    int mixed = 0, differing = 0;
    for (std::size_t pixel = 0; pixel < pixels.frame.pixel_count(); ++pixel) {
        const auto own = pixels.samples.find_visibility(pixel, offsets, SampleReceiver::OwnRay);
        const auto facet = pixels.samples.find_visibility(pixel, offsets, SampleReceiver::CentreFacet);
        if (!pixels.planes.sees_plane_alone(pixel)) {
            differing += own != facet;
            continue;
        }
        EXPECT_EQ(own, facet);
        const int lit = std::accumulate(own.begin(), own.end(), 0);
        mixed += lit > 0 && lit < 25;
    }
    EXPECT_GT(mixed, 30);
    EXPECT_GT(differing, 30) << "at creases and outlines";
}

// The mean of one place in each cell of a grid is off by less than its cells at the border leave open.
TEST(PixelSamples, StratifiedMeansHoldTheArea) {
    SceneView view = random_scene(8, 160, 90);
    view.scene->lights = {make_light(LightKind::Sun, {2, 1.5, 4}, {0, 0, 0})};
    const PixelView pixels(view);
    double bias = 0, squares[2] = {0, 0};
    int border = 0;
    for (std::size_t pixel = 0; pixel < pixels.frame.pixel_count(); ++pixel) {
        if (!pixels.planes.sees_plane_alone(pixel)) continue;
        const double part = pixels.planes.find_lit_part(pixel).value();
        if (part <= 0 || part >= 1) continue;
        ++border;
        for (const int k : {0, 1}) {
            const auto offsets = truth::make_jittered_offsets(k ? 16 : 8, std::uint32_t(pixel));
            const double off = pixels.take_mean(pixel, offsets, SampleReceiver::OwnRay) - part;
            squares[k] += off * off;
            bias += off;
        }
    }
    ASSERT_GT(border, 200);
    // Of n² cells a border crosses about n; each of them is off by 1/3 or so, and all together by n^(1/2) / (3 n²).
    EXPECT_LT(std::sqrt(squares[1] / border), 0.007);
    EXPECT_NEAR(std::sqrt(squares[0] / squares[1]), std::pow(2, 1.5), 0.4);
    EXPECT_LT(std::abs(bias / (2 * border)), 0.003);
}

}  // namespace
}  // namespace shadow_layers::testing
