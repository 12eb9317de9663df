// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scene_draw.h"

#include <algorithm>
#include <numeric>

namespace shadow_layers {
namespace {

/// One element of the instance stream; its layout is set in mesh_cache.cpp.
struct InstanceVertex {
    glm::mat4 clip_from_position;
    std::uint32_t instance;
};
static_assert(sizeof(InstanceVertex) == sizeof(glm::mat4) + sizeof(std::uint32_t));

// Triangles between two looks at the cancel token. llvmpipe draws 5-15 million small triangles a second.
constexpr std::uint64_t kTrianglesPerPiece = 250'000;
constexpr std::size_t kInstanceBlock = 4096;

/// Instances [begin, end) of the sorted order, all of one mesh.
struct Group {
    std::size_t begin, end;
    std::shared_ptr<GpuMesh> mesh;
};

std::vector<std::uint32_t> sort_by_mesh(const SceneDraw& draw) {
    std::vector<std::uint32_t> order(draw.instances.begin(), draw.instances.end());
    const auto& instances = draw.scene.instances;
    const auto by_mesh = [&](std::uint32_t a, std::uint32_t b) { return instances[a].mesh < instances[b].mesh; };
    if (!std::is_sorted(order.begin(), order.end(), by_mesh)) std::stable_sort(order.begin(), order.end(), by_mesh);
    return order;
}

std::vector<Group> make_groups(Engine& engine, const Scene& scene, const std::vector<std::uint32_t>& order) {
    std::vector<Group> groups;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        const std::uint32_t mesh = scene.instances[order[begin]].mesh;
        while (end < order.size() && scene.instances[order[end]].mesh == mesh) ++end;
        if (scene.meshes[mesh]->triangles.empty()) continue;
        engine.check_cancelled();  // sending a mesh may take a while
        groups.push_back({begin, end, engine.meshes().get(engine, *scene.meshes[mesh])});
    }
    return groups;
}

void fill_group(Engine& engine, const SceneDraw& draw, const std::vector<std::uint32_t>& order, const Group& group,
                std::vector<InstanceVertex>& stream) {
    const glm::dvec4 centre(group.mesh->centre, 1.0);
    engine.threads().parallel_for(group.end - group.begin, kInstanceBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = group.begin + begin; i < group.begin + end; ++i) {
            glm::dmat4 clip = draw.clip_from_ws * draw.scene.instances[order[i]].world_from_object;
            clip[3] = clip * centre;
            stream[i] = {glm::mat4(clip), order[i]};
        }
    });
}

/// Draws a group in pieces; `queued` counts the triangles since the last look at the cancel token.
void draw_group(Engine& engine, const Group& group, const gl::Buffer& stream, bool numbered, std::uint64_t& queued) {
    const GladGLContext& gl = engine.gl();
    GpuMesh& mesh = *group.mesh;
    const std::uint64_t triangles = mesh.triangle_count;
    const std::uint64_t triangle_step = std::min(triangles, kTrianglesPerPiece);
    const std::size_t instance_step = std::max<std::size_t>(1, std::size_t(kTrianglesPerPiece / triangle_step));
    mesh.vertices.set_index_buffer(numbered ? *mesh.numbered_index_buf : *mesh.index_buf);
    mesh.vertices.bind();
    for (std::size_t i = group.begin; i < group.end; i += instance_step) {
        const std::size_t count = std::min(instance_step, group.end - i);
        mesh.vertices.set_buffer(1, stream, sizeof(InstanceVertex), i * sizeof(InstanceVertex), 1);
        for (std::uint64_t first = 0; first < triangles; first += triangle_step) {
            const std::uint64_t piece = std::min(triangle_step, triangles - first);
            gl.DrawElementsInstanced(GL_TRIANGLES, GLsizei(3 * piece), GL_UNSIGNED_INT,
                                     reinterpret_cast<const void*>(first * sizeof(glm::uvec3)), GLsizei(count));
            queued += piece * count;
            if (queued < kTrianglesPerPiece) continue;
            queued = 0;
            engine.limit_queue();
            engine.check_cancelled();
        }
    }
}

}  // namespace

void draw_scene(Engine& engine, const gl::Program& program, const DrawState& state, const SceneDraw& draw) {
    engine.check_cancelled();
    const std::vector<std::uint32_t> order = sort_by_mesh(draw);
    const std::vector<Group> groups = make_groups(engine, draw.scene, order);
    if (groups.empty()) return;
    std::vector<InstanceVertex> vertices(order.size());
    for (const Group& group : groups) fill_group(engine, draw, order, group, vertices);
    gl::Buffer& stream = engine.instance_stream(vertices.size() * sizeof(InstanceVertex));
    stream.write(vertices.data(), vertices.size() * sizeof(InstanceVertex));
    apply(engine.gl(), state);
    program.use();
    std::uint64_t queued = 0;
    std::int64_t total = 0;
    for (const Group& group : groups) {
        draw_group(engine, group, stream, draw.numbered, queued);
        total += std::int64_t(group.end - group.begin) * std::int64_t(group.mesh->triangle_count);
    }
    engine.count("triangles", total);
}

}  // namespace shadow_layers
