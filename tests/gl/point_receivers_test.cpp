// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Points with normals as receivers of exact visibility, against every triangle tried one by one.
#include <cmath>
#include <random>

#include "frame/receiver_source.h"
#include "gl_fixture.h"
#include "lights/facing.h"
#include "shadow_layers/error.h"
#include "support/technique_scenes.h"
#include "visibility/exact_visibility.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kPoints = 4000;
constexpr int kTriangles = 300;

struct Soup {
    std::shared_ptr<Scene> scene = std::make_shared<Scene>();
    std::vector<std::array<glm::dvec3, 3>> triangles;  ///< world space
    std::vector<glm::dvec3> places, normals;
};

/// Triangles and points anywhere in a cube about `middle`; the points lie on no triangle.
Soup make_soup(unsigned seed, const glm::dvec3& middle) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    const auto vector = [&] { return glm::dvec3(value(random), value(random), value(random)); };
    Soup soup;
    test::MeshData mesh;
    Instance instance;
    instance.world_from_object = glm::translate(glm::dmat4(1.0), middle);
    for (int t = 0; t < kTriangles; ++t) {
        const glm::dvec3 place = 3.0 * vector();
        for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(place + 0.5 * vector());
        mesh.triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
        std::array<glm::dvec3, 3> corners;
        for (int k = 0; k < 3; ++k) corners[k] = middle + glm::dvec3(mesh.positions[std::size_t(3 * t + k)]);
        soup.triangles.push_back(corners);
    }
    soup.scene->meshes = {test::to_mesh("soup", std::move(mesh))};
    soup.scene->instances = {instance};
    for (std::size_t i = 0; i < kPoints; ++i) {
        soup.places.push_back(middle + 3.5 * vector());
        soup.normals.push_back(3.0 * vector());
    }
    return soup;
}

enum class Answer { Lit, Shadowed, Near };

/// Does the triangle cut the way from `place` by `way`? By areas in the triangle's plane; `Near`: too close to tell.
Answer cut(const glm::dvec3& place, const glm::dvec3& way, bool endless, const std::array<glm::dvec3, 3>& corners) {
    constexpr double kNear = 1e-5;
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double along = glm::dot(normal, way), t = glm::dot(normal, corners[0] - place) / along;
    if (std::abs(along) < kNear * glm::length(normal) * glm::length(way)) return Answer::Near;
    if (t < -kNear || (!endless && t > 1 + kNear)) return Answer::Lit;
    const glm::dvec3 at = place + t * way;
    double least = 1;
    for (int k = 0; k < 3; ++k)
        least = std::min(least, glm::dot(glm::cross(corners[(k + 1) % 3] - corners[k], at - corners[k]), normal) /
                                    glm::dot(normal, normal));
    if (least < -kNear) return Answer::Lit;
    return least > kNear && t > kNear && (endless || t < 1 - kNear) ? Answer::Shadowed : Answer::Near;
}

/// Of one point and the light's centre, from its definition.
Answer find_truth(const Soup& soup, std::size_t i, const Light& light) {
    const glm::dvec3 axis = glm::normalize(glm::dvec3(light.world_from_light[2]));
    const bool is_sun = light.kind == LightKind::Sun;
    const glm::dvec3 way = is_sun ? axis : glm::dvec3(light.world_from_light[3]) - soup.places[i];
    const double cosine = glm::dot(glm::normalize(way), axis);
    if (light.kind == LightKind::Spot || light.kind == LightKind::Area) {
        const double rim = light.kind == LightKind::Area ? 0 : std::cos(0.5 * light.spot_angle);
        if (std::abs(cosine - rim) < 1e-5) return Answer::Near;
        if (cosine < rim) return Answer::Lit;
    }
    const double up = glm::dot(glm::normalize(soup.normals[i]), glm::normalize(way));
    if (std::abs(up) < 1e-5) return Answer::Near;
    if (up < 0) return Answer::Shadowed;
    Answer answer = Answer::Lit;
    for (const auto& corners : soup.triangles) {
        const Answer here = cut(soup.places[i], way, is_sun, corners);
        if (here == Answer::Shadowed) return here;
        if (here == Answer::Near) answer = here;
    }
    return answer;
}

class PointReceiversTest : public test::EngineTest {};

TEST_F(PointReceiversTest, AreExactForEveryKindOfLight) {
    for (const glm::dvec3& middle : {glm::dvec3(0), glm::dvec3(3e5, -2e5, 1e5)}) {
        const Soup soup = make_soup(5, middle);
        const PointReceivers points(*soup.scene, soup.places, soup.normals);
        for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
            const Light light = testing::make_light(kind, middle + glm::dvec3(1, -2, 5), middle, 70);
            const LightSample sample =
                make_light_samples(points.source(), light, {512, 0}, nullptr, &engine().threads()).front();
            ExactVisibility exact;
            const auto& visible = exact.compute(engine(), points.source(), light, sample, 256);
            ASSERT_EQ(visible.size(), kPoints);
            std::array<int, 3> counts{};
            for (std::size_t i = 0; i < kPoints; ++i) {
                const Answer truth = find_truth(soup, i, light);
                ++counts[std::size_t(truth)];
                if (truth == Answer::Near) continue;
                ASSERT_EQ(visible[i], truth == Answer::Lit) << "point " << i << ", kind " << int(kind);
            }
            EXPECT_GT(counts[std::size_t(Answer::Lit)], 100);
            EXPECT_GT(counts[std::size_t(Answer::Shadowed)], 1000);
            EXPECT_LT(counts[std::size_t(Answer::Near)], int(kPoints / 20));
        }
    }
}

TEST_F(PointReceiversTest, BelongToNoGroupAndRefuseWhatIsNoPoint) {
    const Soup soup = make_soup(6, glm::dvec3(0));
    Light light = testing::make_light(LightKind::Sun, {1, -2, 5}, {0, 0, 0});
    light.receiver_set = 0;
    const PointReceivers points(*soup.scene, soup.places, soup.normals);
    const FacingRule rule(points.source(), light, make_light_samples(points.source(), light, {0}).front());
    std::size_t lit = 0;
    for (std::size_t i = 0; i < kPoints; ++i) lit += rule.classify(i) == Facing::Undecided;
    EXPECT_GT(lit, kPoints / 3);
    const std::vector<glm::dvec3> one = {{0, 0, 0}}, none, bad = {{0, NAN, 0}};
    EXPECT_THROW(PointReceivers(*soup.scene, one, none), InputError);
    EXPECT_THROW(PointReceivers(*soup.scene, one, one), InputError);  // a normal without length
    EXPECT_THROW(PointReceivers(*soup.scene, bad, soup.normals), InputError);
    EXPECT_EQ(PointReceivers(*soup.scene, none, none).source().count(), 0u);
}

}  // namespace
}  // namespace shadow_layers
