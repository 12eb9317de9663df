// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mesh_clusters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/thread_pool.h"
#include "support/technique_scenes.h"

namespace shadow_layers::testing {
namespace {

TEST(MeshClusters, BoxesHoldTheirTrianglesAndNoMore) {
    const auto mesh = to_mesh("sphere", make_sphere(2));
    ThreadPool threads(3);
    const MeshClusters clusters = make_mesh_clusters(*mesh, &threads);
    ASSERT_EQ(clusters.boxes.size(), (mesh->triangles.size() + kClusterTriangles - 1) / kClusterTriangles);
    for (std::size_t c = 0; c < clusters.boxes.size(); ++c) {
        glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
        for (std::size_t t = c * kClusterTriangles; t < std::min((c + 1) * kClusterTriangles, mesh->triangles.size());
             ++t)
            for (int k = 0; k < 3; ++k) {
                low = glm::min(low, mesh->positions[mesh->triangles[t][k]]);
                high = glm::max(high, mesh->positions[mesh->triangles[t][k]]);
            }
        EXPECT_EQ(clusters.boxes[c].min, low);
        EXPECT_EQ(clusters.boxes[c].max, high);
    }
    EXPECT_EQ(clusters.byte_size(), clusters.boxes.size() * 24);
}

TEST(MeshClusters, VerticesThatAreNoNumbersDoNotCount) {
    MeshData data = make_plane(2);
    data.positions[0].y = std::numeric_limits<float>::quiet_NaN();
    const MeshClusters some = make_mesh_clusters(*to_mesh("some", data));
    ASSERT_EQ(some.boxes.size(), 1u);
    EXPECT_FALSE(some.boxes[0].is_empty());
    EXPECT_TRUE(std::isfinite(some.boxes[0].min.y) && std::isfinite(some.boxes[0].max.y));
    for (glm::vec3& position : data.positions) position.x = std::numeric_limits<float>::infinity();
    EXPECT_TRUE(make_mesh_clusters(*to_mesh("none", data)).boxes.at(0).is_empty());
    EXPECT_TRUE(make_mesh_clusters(*to_mesh("empty", {})).boxes.empty());
}

}  // namespace
}  // namespace shadow_layers::testing
