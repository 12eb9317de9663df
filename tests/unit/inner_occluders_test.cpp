// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/inner_occluders.h"

#include <gtest/gtest.h>

#include "support/technique_scenes.h"

namespace shadow_layers::testing {
namespace {

/// Every point of every triangle lies nearer to the middle than this.
double find_farthest(const InnerOccluders& occluders) {
    double farthest = 0;
    for (const glm::vec3& p : occluders.mesh->positions) farthest = std::max(farthest, double(glm::length(p)));
    return farthest;
}

MeshData join(MeshData a, const MeshData& b) {
    const auto first = std::uint32_t(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    for (const glm::uvec3& t : b.triangles) a.triangles.push_back(t + first);
    return a;
}

TEST(InnerOccluders, FillASphereAndStayInside) {
    const auto found = make_inner_occluders(*to_mesh("ball", make_sphere(2.0f)));
    ASSERT_TRUE(found->mesh);
    EXPECT_GT(find_farthest(*found), 1.2);
    // Flat faces lie a little inside of the sphere.
    EXPECT_LT(find_farthest(*found), 2.0 * std::cos(3.1416 / 24));
}

TEST(InnerOccluders, AnOpenMeshHasNone) {
    MeshData open = make_sphere(2.0f);
    open.triangles.pop_back();
    EXPECT_FALSE(make_inner_occluders(*to_mesh("open", std::move(open)))->mesh);
    EXPECT_FALSE(make_inner_occluders(*to_mesh("sheet", make_plane(3, 40)))->mesh);
}

TEST(InnerOccluders, AHollowBallHasThemInItsWallOnly) {
    MeshData inner = make_sphere(1.4f, 32, 64);
    const auto found = make_inner_occluders(*to_mesh("hollow", join(make_sphere(2.0f, 32, 64), inner)));
    ASSERT_TRUE(found->mesh);
    // No triangle may come into the hollow: the nearest point of each, found by sampling it.
    for (const glm::uvec3& t : found->mesh->triangles)
        for (int i = 0; i <= 8; ++i)
            for (int j = 0; i + j <= 8; ++j) {
                const glm::vec3 a = found->mesh->positions[t.x], b = found->mesh->positions[t.y],
                                c = found->mesh->positions[t.z];
                const float distance = glm::length(a + float(i) / 8 * (b - a) + float(j) / 8 * (c - a));
                EXPECT_GT(distance, 1.4f * 0.99f);
                EXPECT_LT(distance, 2.0f);
            }
}

TEST(InnerOccluders, OfAPairOfClosedPartsBothAreFilled) {
    MeshData left = make_sphere(1.0f), right = make_sphere(1.0f);
    for (glm::vec3& p : left.positions) p.x -= 3;
    for (glm::vec3& p : right.positions) p.x += 3;
    const auto found = make_inner_occluders(*to_mesh("pair", join(left, right)));
    ASSERT_TRUE(found->mesh);
    bool has_left = false, has_right = false;
    for (const glm::vec3& p : found->mesh->positions) {
        EXPECT_GT(std::abs(p.x), 2.0f);
        has_left = has_left || p.x < 0;
        has_right = has_right || p.x > 0;
    }
    EXPECT_TRUE(has_left && has_right);
}

TEST(InnerOccluders, ACoarseMeshNeedsNone) {
    EXPECT_FALSE(make_inner_occluders(*to_mesh("box", make_box({1, 1, 1})))->mesh);
}

}  // namespace
}  // namespace shadow_layers::testing
